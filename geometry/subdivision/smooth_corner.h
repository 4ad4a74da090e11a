// SPDX-License-Identifier: MIT
// Bicubic splines that meet with continuous tangent planes at a vertex of n faces.
#pragma once

#include <Eigen/Core>
#include <compare>
#include <vector>

#include "geometry/subdivision/extraordinary_ring.h"

namespace batten::internal {

// The inner knots of a spline face beside an extraordinary vertex, in units of the faces of the
// refined mesh: kDouble twice, kSingle once. Two conditions meet at the first, one at the second.
inline constexpr double kDoubleKnot = 1.0 / 3, kSingleKnot = 2.0 / 3;

// A fan of n faces about a vertex, and the angle that it takes in the tangent plane: 2π all round,
// π where the curve of its creases goes on, else that at the corner. Sums and differences of the
// edges at both ends of an open one must not be zero, but with an angle of π or 2π, where these are
// opposite or the same.
struct CornerKind {
  RingKind ring;
  double angle = 0;  // radians
  // Of the inner edges, κ_k in e_{k−1}' + e_{k+1}' = 2 κ_k e_k'; empty: all cos(angle/n), of even
  // sectors. Only at corners of other angles than π and 2π they may be others.
  std::vector<double> cosines = {};

  auto operator<=>(const CornerKind&) const = default;
};

// The n faces at a vertex are bicubic splines over the knots 0⁴, kDoubleKnot², kSingleKnot, 1, 2, …
// in both directions. Their coefficients (i, j), i, j ≤ 3, live on the first unit square only; all
// others are those of the limit surface. With e_k the curve of edge k,
//   ∂S_k/∂v (t, 0) + ∂S_{k−1}/∂u (0, t) = 2 κ_k (1 − t/kDoubleKnot)²₊ e_k'(t)
// makes tangent planes continuous over every edge, and is five linear conditions an edge. Edges
// that are creases keep the creases' own curve instead, the same for both sides. What is left free
// comes as near to the limit surface as least squares at equal parameters and a trace of third
// derivatives can. [the knots: Peters 2000, Fan & Peters 2009; the conditions are derived by
// writing both sides in Bernstein form on the first span, where e_k is quadratic]
class SmoothCorner {
 public:
  explicit SmoothCorner(const CornerKind& kind);

  // The one of a kind; made when first asked for, from any thread.
  static const SmoothCorner& Of(const CornerKind& kind);

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
