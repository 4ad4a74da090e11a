// SPDX-License-Identifier: MIT
#include "fitting/primitives/local_bend.h"

#include <algorithm>
#include <numeric>
#include <optional>

#include "geometry/numeric/dense_solvers.h"

namespace batten::internal {
namespace {

// Bend of the quadric fitted over the plane of the points nearest to `middle`.
std::optional<Bend> BendNear(const Eigen::Vector3d& middle,
                             const Eigen::Matrix3Xd& points,
                             const std::vector<Eigen::Index>& nearest_first,
                             Eigen::Index count) {
  const std::vector<Eigen::Index> chosen(nearest_first.begin(), nearest_first.begin() + count);
  const Eigen::Matrix3Xd near = points(Eigen::all, chosen).colwise() - middle;
  const Eigen::Vector3d mean = near.rowwise().mean();
  const Eigen::Matrix3Xd from = near.colwise() - mean;
  const SymmetricEigen3 frame = EigenOf3(from * from.transpose());
  Eigen::Matrix3d axes;  // tangents, then the normal
  axes << frame.vectors.col(2), frame.vectors.col(1), frame.vectors.col(0);
  if (axes.determinant() < 0) axes.col(2) = -axes.col(2);
  const Eigen::Matrix3Xd local = axes.transpose() * near;
  Eigen::MatrixXd design(count, 6);
  for (Eigen::Index k = 0; k < count; ++k) {
    const double x = local(0, k), y = local(1, k);
    design.row(k) << 1, x, y, x * x / 2, x * y, y * y / 2;
  }
  const Eigen::VectorXd c = LeastSquares(design, local.row(2).transpose());
  if (!c.allFinite()) return std::nullopt;
  const Eigen::Matrix2d hessian{{c[3], c[4]}, {c[4], c[5]}};
  const SymmetricEigen principal = EigenOf(hessian);
  Bend bend;
  bend.normal = (axes * Eigen::Vector3d(-c[1], -c[2], 1)).normalized();
  bend.point = middle + c[0] * axes.col(2);
  for (int i = 0; i < 2; ++i) {
    Eigen::Vector3d direction = axes.leftCols<2>() * principal.vectors.col(i);
    direction -= direction.dot(bend.normal) * bend.normal;
    bend.directions[i] = direction.normalized();
    bend.curvatures[i] = -principal.values[i];
  }
  return bend;
}

}  // namespace

std::vector<Bend> BendsNear(const Eigen::Vector3d& middle, const Eigen::Matrix3Xd& points) {
  std::vector<double> squares(static_cast<size_t>(points.cols()));
  for (Eigen::Index k = 0; k < points.cols(); ++k) {
    squares[k] = (points.col(k) - middle).squaredNorm();
  }
  std::vector<Eigen::Index> order(squares.size());
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  std::sort(order.begin(), order.end(), [&](Eigen::Index a, Eigen::Index b) {
    return squares[a] < squares[b];
  });
  constexpr Eigen::Index kFewest = 9;
  std::vector<Bend> bends;
  for (Eigen::Index count = points.cols(); count >= kFewest; count /= 4) {
    if (const auto bend = BendNear(middle, points, order, count)) bends.push_back(*bend);
  }
  return bends;
}

}  // namespace batten::internal
