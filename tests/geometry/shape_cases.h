// SPDX-License-Identifier: MIT
// Shapes for the tests of their classification: placed at random, over richer bases, arcs.
#pragma once

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <utility>
#include <vector>

#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"
#include "random_splines.h"

namespace batten::internal {

// A turn, a scale between 1e-9 and 1e9 and a shift of at most ten times the scaled size.
struct Placement {
  double scale;
  Eigen::Matrix3d turn;
  Eigen::Vector3d shift;

  explicit Placement(RandomSplines& random)
      : scale(random.Logarithmic(1e-9, 1e9)), turn(random.Orthogonal()) {
    shift = scale * random.Logarithmic(1e-2, 10) * random.Vector(1);
  }
  Eigen::Vector3d Point(const Eigen::Vector3d& p) const { return scale * (turn * p) + shift; }

  NurbsCurve<3> Placed(const NurbsCurve<3>& curve) const {
    return NurbsCurve<3>(curve.basis(),
                         (scale * (turn * curve.control_points())).colwise() + shift,
                         curve.weights());
  }
  NurbsSurface Placed(const NurbsSurface& surface) const {
    return NurbsSurface(surface.basis_u(),
                        surface.basis_v(),
                        (scale * (turn * surface.control_points())).colwise() + shift,
                        surface.weights());
  }
};

// The same columns over another basis that contains the first: by interpolation at the Greville
// abscissae, those outside the domain moved to its ends.
inline Eigen::MatrixXd Converted(const SplineBasis& from,
                                 const Eigen::MatrixXd& columns,
                                 const SplineBasis& to) {
  const int n = to.size(), p = to.degree(), q = from.degree();
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(n, n), values(n, columns.rows());
  std::vector<double> N(kMaxDegree + 1);
  for (int i = 0; i < n; ++i) {
    const double u = to.Clamp(to.Greville(i));
    const int span = to.Span(u);
    to.Values(span, u, N.data());
    for (int r = 0; r <= p; ++r) matrix(i, span - p + r) = N[r];
    const int old_span = from.Span(u);
    from.Values(old_span, u, N.data());
    values.row(i).setZero();
    for (int r = 0; r <= q; ++r) values.row(i) += N[r] * columns.col(old_span - q + r).transpose();
  }
  return matrix.partialPivLu().solve(values).transpose();
}

// The basis of `by` degrees more, and with some more knots.
inline SplineBasis Richer(const SplineBasis& basis, int by, RandomSplines& random) {
  const std::vector<double>& old = basis.knots();
  std::vector<double> knots;
  for (size_t k = 0; k < old.size();) {
    size_t next = k;
    while (next < old.size() && old[next] == old[k]) ++next;
    knots.insert(knots.end(), next - k + by, old[k]);
    if (next < old.size() && random.Coin()) {
      knots.push_back(old[k] + random.Real(0.2, 0.8) * (old[next] - old[k]));
    }
    k = next;
  }
  return SplineBasis(basis.degree() + by, std::move(knots));
}

inline NurbsCurve<2> ConicArc(const Eigen::Matrix<double, 2, 3>& points, double w1) {
  return NurbsCurve<2>(SplineBasis(2, {0, 0, 0, 1, 1, 1}), points, Eigen::Vector3d(1, w1, 1));
}

// An arc of the circle of radius one about the origin, less than half.
inline NurbsCurve<2> CircleArc(double start, double sweep) {
  const double half = sweep / 2, reach = 1 / std::cos(half);
  Eigen::Matrix<double, 2, 3> points;
  points << std::cos(start), reach * std::cos(start + half), std::cos(start + sweep),
      std::sin(start), reach * std::sin(start + half), std::sin(start + sweep);
  return ConicArc(points, std::cos(half));
}

inline NurbsCurve<2> Shifted(const NurbsCurve<2>& curve, double scale, double x, double y) {
  return NurbsCurve<2>(curve.basis(),
                       (scale * curve.control_points()).colwise() + Eigen::Vector2d(x, y),
                       curve.weights());
}

}  // namespace batten::internal
