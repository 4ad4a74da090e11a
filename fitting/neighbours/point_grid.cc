// SPDX-License-Identifier: MIT
#include "fitting/neighbours/point_grid.h"

#include <algorithm>

namespace batten::internal {
namespace {

constexpr int kBits = 21;  // of a cube's number along one axis

}  // namespace

PointGrid::PointGrid(const Eigen::Matrix3Xd& points, double side) : points_(points) {
  corner_ = points.rowwise().minCoeff();
  const Eigen::Array3d reach = points.rowwise().maxCoeff().array() - corner_;
  side_ = std::max(side, reach.maxCoeff() / ((1 << kBits) - 2));
  if (!(side_ > 0)) side_ = 1;
  most_ = (reach / side_).floor().cast<std::int64_t>();
  std::vector<std::pair<std::uint64_t, int>> keys(points.cols());
  for (int k = 0; k < points.cols(); ++k) keys[k] = {KeyOf(CellOf(points.col(k))), k};
  std::sort(keys.begin(), keys.end());
  order_.resize(keys.size());
  for (size_t i = 0; i < keys.size(); ++i) order_[i] = keys[i].second;
  for (size_t begin = 0, end = 0; begin < keys.size(); begin = end) {
    while (end < keys.size() && keys[end].first == keys[begin].first) ++end;
    cells_[keys[begin].first] = {static_cast<int>(begin), static_cast<int>(end)};
  }
}

PointGrid::Cell PointGrid::CellOf(const Eigen::Array3d& place) const {
  const Eigen::Array3d cell = ((place - corner_) / side_).floor();
  return cell.max(0.0).min(most_.array().cast<double>()).cast<std::int64_t>();
}

std::uint64_t PointGrid::KeyOf(const Cell& cell) {
  return (static_cast<std::uint64_t>(cell[2]) << (2 * kBits)) |
         (static_cast<std::uint64_t>(cell[1]) << kBits) | static_cast<std::uint64_t>(cell[0]);
}

std::vector<int> Thinned(const Eigen::Matrix3Xd& points,
                         double radius,
                         const std::vector<int>& preference) {
  if (!(radius > 0)) return preference;
  const PointGrid grid(points, radius);
  std::vector<bool> covered(points.cols(), false);
  std::vector<int> kept;
  for (const int k : preference) {
    if (covered[k]) continue;
    kept.push_back(k);
    grid.ForBall(points.col(k), radius, [&](int other, double) { covered[other] = true; });
  }
  return kept;
}

}  // namespace batten::internal
