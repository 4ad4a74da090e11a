// SPDX-License-Identifier: MIT
// A sample of points that passes by, chosen by the points themselves.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace batten::internal {

// Keeps the points of least hash of their coordinates, different ones only: the same sample
// whatever the order of the points and however they were dealt into parts. [Cohen & Kaplan 2007,
// "Summarizing data using bottom-k sketches"]
class PointSample {
 public:
  // At most `size` points, ≥ 1; another seed, another sample.
  PointSample(Eigen::Index size, std::uint64_t seed);

  void Add(const Eigen::Matrix3Xd& points);

  // How many different points there were: exact up to the size of the sample, else estimated from
  // its largest hash, to 1/√size.
  double Different();

  // The sample by its hashes, and as numbers that Add takes again.
  Eigen::Matrix3Xd Points();

 private:
  struct Entry {
    std::uint64_t hash;
    double x, y, z;
    auto operator<=>(const Entry&) const = default;
  };
  void Shrink();

  std::size_t size_;
  std::uint64_t seed_, limit_;  // entries have hashes below
  std::vector<Entry> entries_;
};

}  // namespace batten::internal
