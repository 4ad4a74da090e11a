// SPDX-License-Identifier: MIT
// A NURBS curve in the plane or in space.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "batten/geometry/spline_basis.h"

namespace batten {

// C(u) = Σ N_i(u) w_i P_i / Σ N_i(u) w_i on the domain of its basis. A value: editing returns a new
// one. Parameters outside the domain are taken at its nearest end or, over a periodic basis, whole
// periods away (SplineBasis::Clamp). [Piegl & Tiller 1997, §4.2]
template <int Dim>
class NurbsCurve {
 public:
  using Point = Eigen::Matrix<double, Dim, 1>;
  using Points = Eigen::Matrix<double, Dim, Eigen::Dynamic>;

  // Control points are Euclidean (Dim × n, the data's units); no weights means all ones. Throws
  // std::invalid_argument unless sizes agree, everything is finite, weights are positive and, over
  // a periodic basis, the last p control points and weights are the first p.
  NurbsCurve(SplineBasis basis, Points control_points, Eigen::VectorXd weights = {});

  const SplineBasis& basis() const { return basis_; }
  const Points& control_points() const { return control_points_; }
  const Eigen::VectorXd& weights() const { return weights_; }
  bool rational() const { return rational_; }  // weights differ

  Point At(double u) const;

  // Column k is the k-th derivative, k = 0 … order; right-continuous at knots, left at the end.
  Points Derivatives(double u, int order) const;

  bool operator==(const NurbsCurve&) const = default;

 private:
  SplineBasis basis_;
  Points control_points_;
  Eigen::VectorXd weights_;
  bool rational_;
};

extern template class NurbsCurve<2>;
extern template class NurbsCurve<3>;

}  // namespace batten
