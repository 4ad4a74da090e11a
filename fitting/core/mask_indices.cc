// SPDX-License-Identifier: MIT
#include "fitting/core/mask_indices.h"

namespace batten::internal {

std::vector<Eigen::Index> IndicesOf(const PointMask& mask) {
  std::vector<Eigen::Index> indices;
  for (Eigen::Index k = 0; k < mask.size(); ++k)
    if (mask[k]) indices.push_back(k);
  return indices;
}

std::vector<Eigen::Index> IndicesOf(const PointMask& mask, Eigen::Index most) {
  const std::vector<Eigen::Index> all = IndicesOf(mask);
  const auto count = static_cast<Eigen::Index>(all.size());
  if (count <= most) return all;
  std::vector<Eigen::Index> some;
  for (Eigen::Index k = 0; k < most; ++k)
    some.push_back(all[static_cast<size_t>(k * count / most)]);
  return some;
}

}  // namespace batten::internal
