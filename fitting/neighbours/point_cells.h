// SPDX-License-Identifier: MIT
// Points of the plane in square cells of one width.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace batten::internal {

// Keeps a reference to the points.
class PointCells {
 public:
  static constexpr int kParts = 4;  // of a cell's width, each occupied or empty

  // From the corner on; `extent` is that of the points.
  PointCells(const Eigen::Matrix2Xd& points,
             const Eigen::Vector2d& corner,
             double width,
             const Eigen::Vector2d& extent);

  const Eigen::Matrix2Xd& points() const { return points_; }
  std::int64_t nu() const { return nu_; }
  std::int64_t nv() const { return nv_; }
  double width() const { return width_; }

  std::size_t Of(const Eigen::Vector2d& place) const {
    const Eigen::Vector2d from = (place - corner_) / width_;
    const auto i = std::min(static_cast<std::int64_t>(from[0]), nu_ - 1);
    const auto j = std::min(static_cast<std::int64_t>(from[1]), nv_ - 1);
    return static_cast<std::size_t>(j * nu_ + i);
  }

  // The points of all cells one after the other, and of one.
  std::span<const Eigen::Index> All() const { return order_; }
  std::span<const Eigen::Index> In(std::size_t cell) const {
    return {order_.data() + first_[cell], order_.data() + first_[cell + 1]};
  }

  // What is around a cell: itself and its eight neighbours.
  template <typename Visit>
  void Around(std::size_t cell, const Visit& visit) const {
    const std::int64_t i = static_cast<std::int64_t>(cell) % nu_,
                       j = static_cast<std::int64_t>(cell) / nu_;
    for (std::int64_t y = std::max<std::int64_t>(0, j - 1); y <= std::min(nv_ - 1, j + 1); ++y)
      for (std::int64_t x = std::max<std::int64_t>(0, i - 1); x <= std::min(nu_ - 1, i + 1); ++x)
        visit(static_cast<std::size_t>(y * nu_ + x));
  }

  // The points around a place that are nearest to it, with their squared distances; none where
  // there are fewer than `most`.
  std::vector<std::pair<double, Eigen::Index>> Nearest(const Eigen::Vector2d& place,
                                                       std::size_t most) const;

  // The parts of a cell, `kParts` in each direction, that hold a point; by their area.
  std::vector<float> OccupiedAreas() const;

 private:
  int PartOf(std::size_t cell, Eigen::Index point) const;

  const Eigen::Matrix2Xd& points_;
  Eigen::Vector2d corner_;
  double width_;
  std::int64_t nu_, nv_;
  std::vector<Eigen::Index> first_;  // of every cell in order_, and the end
  std::vector<Eigen::Index> order_;
};

}  // namespace batten::internal
