// SPDX-License-Identifier: MIT
#include "fitting/neighbours/point_cells.h"

namespace batten::internal {

using Index = Eigen::Index;

PointCells::PointCells(const Eigen::Matrix2Xd& points,
                       const Eigen::Vector2d& corner,
                       double width,
                       const Eigen::Vector2d& extent)
    : points_(points),
      corner_(corner),
      width_(width),
      nu_(static_cast<std::int64_t>(extent[0] / width) + 1),
      nv_(static_cast<std::int64_t>(extent[1] / width) + 1),
      first_(static_cast<size_t>(nu_ * nv_) + 1, 0),
      order_(static_cast<size_t>(points.cols())) {
  for (const auto& point : points.colwise()) ++first_[Of(point) + 1];
  for (size_t cell = 1; cell < first_.size(); ++cell) first_[cell] += first_[cell - 1];
  std::vector<Index> next(first_.begin(), first_.end() - 1);
  for (Index k = 0; k < points.cols(); ++k)
    order_[static_cast<size_t>(next[Of(points.col(k))]++)] = k;
}

std::vector<std::pair<double, Index>> PointCells::Nearest(const Eigen::Vector2d& place,
                                                          size_t most) const {
  std::vector<std::pair<double, Index>> nearest;
  Around(Of(place), [&](size_t cell) {
    for (const Index near : In(cell))
      nearest.emplace_back((points_.col(near) - place).squaredNorm(), near);
  });
  if (nearest.size() < most) return {};
  std::partial_sort(nearest.begin(), nearest.begin() + static_cast<Index>(most), nearest.end());
  nearest.resize(most);
  return nearest;
}

std::vector<float> PointCells::OccupiedAreas() const {
  std::vector<float> areas(first_.size() - 1, 0);
  for (size_t cell = 0; cell < areas.size(); ++cell) {
    unsigned marks = 0;
    for (const Index point : In(cell)) marks |= 1U << PartOf(cell, point);
    areas[cell] =
        static_cast<float>(__builtin_popcount(marks) * width_ * width_ / (kParts * kParts));
  }
  return areas;
}

int PointCells::PartOf(size_t cell, Index point) const {
  const Eigen::Vector2d from = (points_.col(point) - corner_) / width_;
  const auto part = [&](double along, std::int64_t at) {
    return std::clamp(static_cast<int>((along - static_cast<double>(at)) * kParts), 0, kParts - 1);
  };
  const auto at = static_cast<std::int64_t>(cell);
  return part(from[1], at / nu_) * kParts + part(from[0], at % nu_);
}

}  // namespace batten::internal
