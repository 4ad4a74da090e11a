// SPDX-License-Identifier: MIT
#include "batten/fitting/point_mask.h"

#include <numeric>
#include <random>

namespace batten {

std::vector<Eigen::Index> SampleIndices(Eigen::Index size, Eigen::Index count, std::uint64_t seed) {
  std::vector<Eigen::Index> indices;
  if (count >= size) {
    indices.resize(static_cast<size_t>(size));
    std::iota(indices.begin(), indices.end(), Eigen::Index{0});
    return indices;
  }
  // One from each of `count` equal stretches: spread over the file and all different.
  std::mt19937_64 random(seed);
  indices.reserve(static_cast<size_t>(count));
  for (Eigen::Index i = 0; i < count; ++i) {
    const Eigen::Index begin = size * i / count, end = size * (i + 1) / count;
    indices.push_back(
        begin + static_cast<Eigen::Index>(random() % static_cast<std::uint64_t>(end - begin)));
  }
  return indices;
}

}  // namespace batten
