// SPDX-License-Identifier: MIT
#include "fitting/uncertainty/spline_shape.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <vector>

namespace batten::internal {
namespace {

// Derivatives 0 … order of the functions of one basis that act at a parameter, row by row.
struct Functions {
  int span = 0, order;
  Eigen::MatrixXd values;

  Functions(const SplineBasis* basis, double parameter, int order)
      : order(order), values(Eigen::MatrixXd::Zero(order + 1, 1)) {
    values(0, 0) = 1;
    if (basis == nullptr) return;
    const double at = basis->Clamp(parameter);
    span = basis->Span(at);
    std::vector<double> rows(static_cast<size_t>((order + 1) * (basis->degree() + 1)));
    basis->Derivatives(span, at, order, rows.data());
    values =
        Eigen::Map<const Eigen::MatrixXd>(rows.data(), basis->degree() + 1, order + 1).transpose();
  }
};

Eigen::Vector3d UnitOrZero(const Eigen::Vector3d& vector) {
  const double length = vector.norm();
  return length > 0 ? Eigen::Vector3d(vector / length) : Eigen::Vector3d::Zero();
}

}  // namespace

ShapePlace PlaceOn(const SplineShape& shape, double u, double v) {
  const Functions fu(&shape.u, u, 2), fv(shape.v ? &*shape.v : nullptr, v, 1);
  ShapePlace place;
  place.span_u = fu.span;
  place.span_v = fv.span;
  place.count_u = static_cast<int>(fu.values.cols());
  place.count_v = static_cast<int>(fv.values.cols());
  place.functions.resize(Eigen::Index{place.count_u} * place.count_v);
  const auto dimension = shape.points.rows();
  // Weighted sums of the value and the derivatives u, v, uu.
  Eigen::Matrix<double, 4, 4> sums = Eigen::Matrix4d::Zero();
  const Eigen::Vector3d middle = [&] {
    Eigen::Vector3d first = Eigen::Vector3d::Zero();
    first.head(dimension) = shape.points.col(place.Index(0, 0, shape.size_v()));
    return first;
  }();
  for (int i = 0, k = 0; i < place.count_u; ++i) {
    for (int j = 0; j < place.count_v; ++j, ++k) {
      const int index = place.Index(i, j, shape.size_v());
      const double weight = shape.weights[index];
      Eigen::Vector4d point = Eigen::Vector4d::Zero();
      point.head(dimension) = shape.points.col(index);
      point.head<3>() -= middle;
      point[3] = 1;
      place.functions[k] = weight * fu.values(0, i) * fv.values(0, j);
      sums.col(0) += place.functions[k] * point;
      sums.col(1) += weight * fu.values(1, i) * fv.values(0, j) * point;
      sums.col(2) += weight * fu.values(0, i) * fv.values(1, j) * point;
      sums.col(3) += weight * fu.values(2, i) * fv.values(0, j) * point;
    }
  }
  const double w = sums(3, 0);
  place.functions /= w;
  const Eigen::Vector3d at = sums.col(0).head<3>() / w;
  const Eigen::Vector3d du = (sums.col(1).head<3>() - sums(3, 1) * at) / w;
  const Eigen::Vector3d dv = (sums.col(2).head<3>() - sums(3, 2) * at) / w;
  place.position = middle + at;
  if (shape.v) {
    place.normal = UnitOrZero(du.cross(dv));
  } else if (dimension == 2) {
    place.normal = UnitOrZero({-du[1], du[0], 0});
  } else {
    const Eigen::Vector3d duu = (sums.col(3).head<3>() - 2 * sums(3, 1) * du - sums(3, 3) * at) / w;
    const Eigen::Vector3d along = UnitOrZero(du), bend = duu - along.dot(duu) * along;
    place.normal = bend.norm() > 1e-9 * duu.norm() ? UnitOrZero(bend)
                   : along.isZero(0)               ? along
                                                   : along.unitOrthogonal().eval();
  }
  return place;
}

}  // namespace batten::internal
