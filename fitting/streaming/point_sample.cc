// SPDX-License-Identifier: MIT
#include "fitting/streaming/point_sample.h"

#include <algorithm>
#include <bit>
#include <limits>

namespace batten::internal {
namespace {

// One step of SplitMix64. [Steele, Lea & Flood 2014]
std::uint64_t Mixed(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9;
  x = (x ^ (x >> 27)) * 0x94d049bb133111eb;
  return x ^ (x >> 31);
}

std::uint64_t BitsOf(double value) { return std::bit_cast<std::uint64_t>(value + 0.0); }  // −0 is 0

}  // namespace

PointSample::PointSample(Eigen::Index size, std::uint64_t seed)
    : size_(static_cast<std::size_t>(size)),
      seed_(Mixed(seed)),
      limit_(std::numeric_limits<std::uint64_t>::max()) {}

void PointSample::Add(const Eigen::Matrix3Xd& points) {
  for (Eigen::Index k = 0; k < points.cols(); ++k) {
    const double* p = points.data() + 3 * k;
    const std::uint64_t hash =
        Mixed(Mixed(Mixed(seed_ ^ BitsOf(p[0])) ^ BitsOf(p[1])) ^ BitsOf(p[2]));
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
