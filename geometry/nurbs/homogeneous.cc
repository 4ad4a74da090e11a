// SPDX-License-Identifier: MIT
#include "geometry/nurbs/homogeneous.h"

#include <utility>

namespace batten::internal {
namespace {

// Over a periodic basis the last p columns are the first p again, bit by bit.
Eigen::MatrixXd Wrapped(const SplineBasis& basis, Eigen::MatrixXd columns) {
  if (!basis.periodic()) return columns;
  const int round = basis.size() - basis.degree();
  for (int i = round; i < basis.size(); ++i) columns.col(i) = columns.col(i - round).eval();
  return columns;
}

}  // namespace

template <int Dim>
Eigen::MatrixXd Homogeneous(const NurbsCurve<Dim>& curve) {
  Eigen::MatrixXd columns = Eigen::MatrixXd::Ones(Dim + 1, curve.basis().size());
  if (curve.rational()) columns.row(Dim) = curve.weights().transpose();
  columns.topRows<Dim>() = curve.control_points() * columns.row(Dim).asDiagonal();
  return columns;
}

template <int Dim>
NurbsCurve<Dim> CurveFromHomogeneous(SplineBasis basis,
                                     const Eigen::MatrixXd& columns,
                                     bool rational) {
  const Eigen::MatrixXd all = Wrapped(basis, columns);
  if (!rational) return NurbsCurve<Dim>(std::move(basis), all.topRows(Dim));
  return NurbsCurve<Dim>(std::move(basis),
                         all.topRows(Dim).array().rowwise() / all.row(Dim).array(),
                         all.row(Dim).transpose());
}

template Eigen::MatrixXd Homogeneous(const NurbsCurve<2>&);
template Eigen::MatrixXd Homogeneous(const NurbsCurve<3>&);
template NurbsCurve<2> CurveFromHomogeneous(SplineBasis, const Eigen::MatrixXd&, bool);
template NurbsCurve<3> CurveFromHomogeneous(SplineBasis, const Eigen::MatrixXd&, bool);

const SplineBasis& BasisOf(const NurbsSurface& surface, Direction direction) {
  return direction == Direction::kU ? surface.basis_u() : surface.basis_v();
}

Eigen::MatrixXd HomogeneousRows(const NurbsSurface& surface, Direction direction) {
  const int n = surface.size_u(), m = surface.size_v();
  const bool along_u = direction == Direction::kU;
  Eigen::MatrixXd columns(4 * (along_u ? m : n), along_u ? n : m);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < m; ++j) {
      const Eigen::Index k = Eigen::Index{i} * m + j;
      const double w = surface.rational() ? surface.weights()[k] : 1;
      Eigen::Vector4d h;
      h << w * surface.control_points().col(k), w;
      columns.block<4, 1>(4 * (along_u ? j : i), along_u ? i : j) = h;
    }
  }
  return columns;
}

NurbsSurface SurfaceFromHomogeneous(const NurbsSurface& like,
                                    Direction direction,
                                    SplineBasis basis,
                                    const Eigen::MatrixXd& columns) {
  const bool along_u = direction == Direction::kU;
  const Eigen::MatrixXd all = Wrapped(basis, columns);
  const int n = along_u ? basis.size() : like.size_u(), m = along_u ? like.size_v() : basis.size();
  Eigen::Matrix3Xd points(3, Eigen::Index{n} * m);
  Eigen::VectorXd weights = Eigen::VectorXd::Ones(points.cols());
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < m; ++j) {
      const Eigen::Index k = Eigen::Index{i} * m + j;
      const Eigen::Vector4d h = all.block<4, 1>(4 * (along_u ? j : i), along_u ? i : j);
      points.col(k) = h.head<3>();
      if (!like.rational()) continue;
      weights[k] = h[3];
      points.col(k) /= h[3];
    }
  }
  if (along_u) {
    return NurbsSurface(std::move(basis), like.basis_v(), std::move(points), std::move(weights));
  }
  return NurbsSurface(like.basis_u(), std::move(basis), std::move(points), std::move(weights));
}

}  // namespace batten::internal
