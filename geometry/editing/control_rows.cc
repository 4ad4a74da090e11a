// SPDX-License-Identifier: MIT
#include "geometry/editing/control_rows.h"

#include <utility>

#include "batten/geometry/knot_vectors.h"

namespace batten::internal {
namespace {

// Where the control point of a row and an index along the direction stands in a net.
struct NetOrder {
  bool along_u;
  Eigen::Index size_v;
  Eigen::Index operator()(Eigen::Index row, Eigen::Index i) const {
    return along_u ? i * size_v + row : row * size_v + i;
  }
};

// The column that column i repeats: over a periodic basis the last p are the first p again.
Eigen::Index Original(const SplineBasis& basis, Eigen::Index i) {
  return basis.periodic() ? i % (basis.size() - basis.degree()) : i;
}

}  // namespace

ControlRows::Point ControlRows::At(Eigen::Index row, Eigen::Index i) const {
  Point point;
  for (int d = 0; d < dimension(); ++d) point.place[d] = coordinates[d](row, i);
  if (rational()) point.weight = weights(row, i);
  return point;
}

void ControlRows::Set(Eigen::Index row, Eigen::Index i, const Point& point) {
  for (int d = 0; d < dimension(); ++d) coordinates[d](row, i) = point.place[d];
  if (rational()) weights(row, i) = point.weight;
}

ControlRows EmptyRows(const ControlRows& like, SplineBasis basis) {
  const Eigen::MatrixXd zero = Eigen::MatrixXd::Zero(like.rows(), basis.size());
  return {std::move(basis),
          std::vector<Eigen::MatrixXd>(like.coordinates.size(), zero),
          like.rational() ? zero : Eigen::MatrixXd(),
          like.common_weight};
}

ControlRows ColumnsOf(const ControlRows& rows, Eigen::Index first, SplineBasis basis) {
  const Eigen::Index count = basis.size();
  ControlRows result{std::move(basis), {}, {}, rows.common_weight};
  for (const Eigen::MatrixXd& x : rows.coordinates) {
    result.coordinates.push_back(x.middleCols(first, count));
  }
  if (rows.rational()) result.weights = rows.weights.middleCols(first, count);
  return result;
}

ControlRows ReversedRows(ControlRows rows) {
  rows.basis = Reversed(rows.basis);
  for (Eigen::MatrixXd& x : rows.coordinates) x = x.rowwise().reverse().eval();
  if (rows.rational()) rows.weights = rows.weights.rowwise().reverse().eval();
  return rows;
}

template <int Dim>
ControlRows RowsOf(const NurbsCurve<Dim>& curve) {
  ControlRows rows{curve.basis(), {}, {}, curve.weights()[0]};
  for (int d = 0; d < Dim; ++d) rows.coordinates.push_back(curve.control_points().row(d));
  if (curve.rational()) rows.weights = curve.weights().transpose();
  return rows;
}

ControlRows RowsOf(const NurbsSurface& surface, Direction direction) {
  const bool along_u = direction == Direction::kU;
  const NetOrder order{along_u, surface.size_v()};
  const Eigen::Index n = along_u ? surface.size_u() : surface.size_v();
  const Eigen::Index m = along_u ? surface.size_v() : surface.size_u();
  ControlRows rows{along_u ? surface.basis_u() : surface.basis_v(),
                   std::vector<Eigen::MatrixXd>(3, Eigen::MatrixXd(m, n)),
                   {},
                   surface.weights()[0]};
  if (surface.rational()) rows.weights.resize(m, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index row = 0; row < m; ++row) {
      const Eigen::Index k = order(row, i);
      rows.Set(row, i, {surface.control_points().col(k), surface.weights()[k]});
    }
  }
  return rows;
}

template <int Dim>
NurbsCurve<Dim> CurveOf(const ControlRows& rows) {
  const Eigen::Index n = rows.basis.size();
  typename NurbsCurve<Dim>::Points points(Dim, n);
  Eigen::VectorXd weights = Eigen::VectorXd::Constant(n, rows.common_weight);
  for (Eigen::Index i = 0; i < n; ++i) {
    const ControlRows::Point point = rows.At(0, Original(rows.basis, i));
    points.col(i) = point.place.head<Dim>();
    if (rows.rational()) weights[i] = point.weight;
  }
  return NurbsCurve<Dim>(rows.basis, std::move(points), std::move(weights));
}

NurbsSurface SurfaceOf(const ControlRows& rows, Direction direction, const SplineBasis& other) {
  const bool along_u = direction == Direction::kU;
  const Eigen::Index n = rows.basis.size(), m = other.size();
  const NetOrder order{along_u, along_u ? m : n};
  Eigen::Matrix3Xd points(3, n * m);
  Eigen::VectorXd weights = Eigen::VectorXd::Constant(n * m, rows.common_weight);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index row = 0; row < m; ++row) {
      const ControlRows::Point point = rows.At(row, Original(rows.basis, i));
      const Eigen::Index k = order(row, i);
      points.col(k) = point.place;
      if (rows.rational()) weights[k] = point.weight;
    }
  }
  const SplineBasis &u = along_u ? rows.basis : other, &v = along_u ? other : rows.basis;
  return NurbsSurface(u, v, std::move(points), std::move(weights));
}

const SplineBasis& OtherBasis(const NurbsSurface& surface, Direction direction) {
  return direction == Direction::kU ? surface.basis_v() : surface.basis_u();
}

template ControlRows RowsOf(const NurbsCurve<2>&);
template ControlRows RowsOf(const NurbsCurve<3>&);
template NurbsCurve<2> CurveOf(const ControlRows&);
template NurbsCurve<3> CurveOf(const ControlRows&);

}  // namespace batten::internal
