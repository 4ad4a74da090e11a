// SPDX-License-Identifier: MIT
// Bicubic splines that meet with continuous tangent planes at a vertex of n edges.
#pragma once

#include <Eigen/Core>

#include "geometry/subdivision/extraordinary_ring.h"

namespace batten::internal {

// The inner knots of a spline face beside an extraordinary vertex, in units of the faces of the
// refined mesh: kDouble twice, kSingle once. Two conditions meet at the first, one at the second.
inline constexpr double kDoubleKnot = 1.0 / 3, kSingleKnot = 2.0 / 3;

// The n faces at a vertex are bicubic splines over the knots 0⁴, kDoubleKnot², kSingleKnot, 1, 2, …
// in both directions. Their coefficients (i, j), i, j ≤ 3, live on the first unit square only; all
// others are those of the limit surface. With e_k the curve of edge k,
//   ∂S_k/∂v (t, 0) + ∂S_{k−1}/∂u (0, t) = 2 cos(2π/n) (1 − t/kDoubleKnot)²₊ e_k'(t)
// makes tangent planes continuous over every edge, and is five linear conditions an edge. What they
// leave free comes as near to the limit surface as least squares at equal parameters and a trace of
// third derivatives can. [the knots: Peters 2000, Fan & Peters 2009; the conditions are derived by
// writing both sides in Bernstein form on the first span, where e_k is quadratic]
class SmoothCorner {
 public:
  explicit SmoothCorner(int valence);

  // The one of a valence; made when first asked for, from any thread.
  static const SmoothCorner& Of(int valence);

  // The net of three rings from which the coefficients come.
  const RingPlaces& net() const { return net_; }
  // Coefficients 4 × 4 of every sector, with shared ones once: RingPlaces of three rings again.
  // Coefficients = net (3 × size) · mask()ᵀ.
  const Eigen::MatrixXd& mask() const { return mask_; }

 private:
  RingPlaces net_;
  Eigen::MatrixXd mask_;
};

// The polar form of the uniform cubic piece over [0, 1] at three arguments: the weights of its four
// control points. [Ramshaw 1989]
std::array<double, 4> UniformCubicBlossom(double a, double b, double c);

}  // namespace batten::internal
