// SPDX-License-Identifier: MIT
// A hashed grid of cubes over a cloud, for fixed-radius searches.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <unordered_map>
#include <utility>
#include <vector>

namespace batten::internal {

// A grid of cubes of one side over a cloud. Building takes O(m log m); a search with a radius of
// about the side visits 27 cubes and their points. Keeps a reference to the points.
class PointGrid {
 public:
  PointGrid(const Eigen::Matrix3Xd& points, double side);

  // Calls visit(index, squared distance) for every point within `radius` of `centre`, in an order
  // that depends on nothing but the points.
  template <typename Visit>
  void ForBall(const Eigen::Vector3d& centre, double radius, const Visit& visit) const {
    const Cell low = CellOf(centre.array() - radius), high = CellOf(centre.array() + radius);
    for (std::int64_t z = low[2]; z <= high[2]; ++z) {
      for (std::int64_t y = low[1]; y <= high[1]; ++y) {
        for (std::int64_t x = low[0]; x <= high[0]; ++x) {
          const auto found = cells_.find(KeyOf({x, y, z}));
          if (found == cells_.end()) continue;
          for (int i = found->second.first; i < found->second.second; ++i) {
            const int k = order_[i];
            const double square = (points_.col(k) - centre).squaredNorm();
            if (square <= radius * radius) visit(k, square);
          }
        }
      }
    }
  }

 private:
  using Cell = Eigen::Matrix<std::int64_t, 3, 1>;
  Cell CellOf(const Eigen::Array3d& place) const;
  static std::uint64_t KeyOf(const Cell& cell);

  const Eigen::Matrix3Xd& points_;
  Eigen::Array3d corner_;
  double side_;
  Cell most_ = Cell::Zero();
  std::vector<int> order_;
  std::unordered_map<std::uint64_t, std::pair<int, int>> cells_;
};

// Thins points greedily in the given order of preference: no two points kept are nearer than
// `radius`, and every other point is within it of one kept. O(m) searches.
std::vector<int> Thinned(const Eigen::Matrix3Xd& points,
                         double radius,
                         const std::vector<int>& preference);

}  // namespace batten::internal
