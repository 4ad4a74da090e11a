// SPDX-License-Identifier: MIT
// Orthogonal coordinates of a tube, round it and along it.
#pragma once

#include <Eigen/Core>

#include "batten/geometry/nurbs_surface.h"
#include "batten/geometry/thread_pool.h"

namespace batten::internal {

// Smooth orthogonal coordinates on the parameter domain of a surface closed in u: `round` grows by
// length_round once round it, `along` from 0 at one end to length_along at the other. Their level
// lines meet at right angles on the surface, and each coordinate is scaled, as a function of itself
// alone, to be as near to length as possible. On a surface of revolution they are angle times a
// mean radius, and length of the profile; on a pipe bent in a circle, the angles round pipe and
// bend.
class TubeChart {
 public:
  // Computes the harmonic function that grows by one round the surface and the one that grows by
  // one along it, by least Dirichlet energy among bicubic splines; then scales each by the spline
  // function of it alone that minimises ∫ (|gradient| − 1)². `u` of the surface's basis is periodic
  // and the partial derivatives are independent; else the result is not finite. [isothermic
  // coordinates: do Carmo 1976, §4-2; circular ones: Gu & Yau 2003]
  // O(cells along) for a fixed number of cells round.
  explicit TubeChart(const NurbsSurface& surface);

  double length_round() const { return length_round_; }
  double length_along() const { return length_along_; }
  double distortion() const { return distortion_; }  // of lengths, relative: root mean square
  double folded() const { return folded_; }          // share of the area that is turned over

  // (round, along) at parameters (u, v) of the surface; round in [0, length_round).
  Eigen::Matrix2Xd At(const Eigen::Matrix2Xd& parameters, ThreadPool& pool) const;

 private:
  SplineBasis basis_u_, basis_v_;
  Eigen::VectorXd round_, along_;  // coefficients of what is added to u / period, and of the other
  SplineBasis round_basis_, along_basis_;
  Eigen::VectorXd round_scale_, along_scale_;  // coefficients of lengths over either function
  double length_round_ = 0, length_along_ = 0, distortion_ = 0, folded_ = 0;
};

}  // namespace batten::internal
