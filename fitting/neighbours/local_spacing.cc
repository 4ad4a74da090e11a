// SPDX-License-Identifier: MIT
#include "fitting/neighbours/local_spacing.h"

#include <algorithm>
#include <cmath>

namespace batten::internal {
namespace {

constexpr double kWidth = 8;
constexpr int kParts = 4;       // of a cell's width, each occupied or empty
constexpr double kSure = 0.85;  // borders of a part that is evenly dense look this much sparser
constexpr double kFewest = 20;  // points around a cell; below, its spacing is 1
constexpr double kMostPlaces = 1e7;  // limit on the number of all parts

}  // namespace

LocalSpacing::LocalSpacing(const Eigen::Matrix2Xd& points) {
  corner_ = points.rowwise().minCoeff();
  const Eigen::Vector2d extent = points.rowwise().maxCoeff() - corner_;
  side_ = std::max(kWidth, kParts * std::sqrt(extent.prod() / kMostPlaces));
  nu_ = static_cast<std::int64_t>(extent[0] / side_) + 1;
  nv_ = static_cast<std::int64_t>(extent[1] / side_) + 1;
  std::vector<std::uint8_t> occupied(static_cast<size_t>(nu_ * nv_) * kParts * kParts, 0);
  std::vector<float> counts(static_cast<size_t>(nu_ * nv_), 0), areas = counts;
  const double part = side_ / kParts;
  for (Eigen::Index k = 0; k < points.cols(); ++k) {
    const Eigen::Vector2d from = points.col(k) - corner_;
    const auto i = std::min(static_cast<std::int64_t>(from[0] / part), nu_ * kParts - 1);
    const auto j = std::min(static_cast<std::int64_t>(from[1] / part), nv_ * kParts - 1);
    const std::int64_t place = j / kParts * nu_ + i / kParts;
    counts[place] += 1;
    std::uint8_t& mark = occupied[j * nu_ * kParts + i];
    if (mark == 0) areas[place] += static_cast<float>(part * part);
    mark = 1;
  }
  spacing_.assign(counts.size(), 1);
  for (std::int64_t j = 0; j < nv_; ++j) {
    for (std::int64_t i = 0; i < nu_; ++i) {
      double count = 0, area = 0;
      for (std::int64_t y = std::max<std::int64_t>(0, j - 1); y <= std::min(nv_ - 1, j + 1); ++y)
        for (std::int64_t x = std::max<std::int64_t>(0, i - 1); x <= std::min(nu_ - 1, i + 1);
             ++x) {
          count += counts[y * nu_ + x];
          area += areas[y * nu_ + x];
        }
      if (count < kFewest) continue;
      spacing_[j * nu_ + i] =
          static_cast<float>(std::clamp(kSure * std::sqrt(area / count), 1.0, 2.0));
    }
  }
}

double LocalSpacing::At(const Eigen::Vector2d& place) const {
  const Eigen::Array2d cell = ((place - corner_) / side_).array().floor();
  const auto i = static_cast<std::int64_t>(std::clamp(cell[0], 0.0, static_cast<double>(nu_ - 1)));
  const auto j = static_cast<std::int64_t>(std::clamp(cell[1], 0.0, static_cast<double>(nv_ - 1)));
  return spacing_[j * nu_ + i];
}

}  // namespace batten::internal
