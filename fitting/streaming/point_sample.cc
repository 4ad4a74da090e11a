// SPDX-License-Identifier: MIT
#include "fitting/streaming/point_sample.h"

#include <algorithm>
#include <limits>

#include "geometry/numeric/mixed_bits.h"

namespace batten::internal {
PointSample::PointSample(Eigen::Index size, std::uint64_t seed)
    : size_(static_cast<std::size_t>(size)),
      seed_(Mixed(seed)),
      limit_(std::numeric_limits<std::uint64_t>::max()) {}

void PointSample::Add(const Eigen::Matrix3Xd& points) {
  for (Eigen::Index k = 0; k < points.cols(); ++k) {
    const double* p = points.data() + 3 * k;
    const std::uint64_t hash = MixedBitsOf(p, seed_);
    if (hash >= limit_) continue;
    entries_.push_back({hash, p[0], p[1], p[2]});
    if (entries_.size() >= 2 * size_ + 64) Shrink();
  }
}

void PointSample::Shrink() {
  std::sort(entries_.begin(), entries_.end());
  entries_.erase(std::unique(entries_.begin(), entries_.end()), entries_.end());
  if (entries_.size() <= size_) return;
  limit_ = entries_[size_].hash;
  entries_.resize(size_);
}

double PointSample::Different() {
  Shrink();
  const auto count = static_cast<double>(entries_.size());
  if (entries_.size() < size_) return count;
  return count / (static_cast<double>(entries_.back().hash) * 0x1p-64);
}

Eigen::Matrix3Xd PointSample::Points() {
  Shrink();
  Eigen::Matrix3Xd points(3, static_cast<Eigen::Index>(entries_.size()));
  for (Eigen::Index k = 0; k < points.cols(); ++k) {
    const Entry& entry = entries_[static_cast<std::size_t>(k)];
    points.col(k) << entry.x, entry.y, entry.z;
  }
  return points;
}

}  // namespace batten::internal
