// SPDX-License-Identifier: MIT
#include "fitting/parameterization/empty_area_fraction.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace batten::internal {

double EmptyAreaFraction(const Eigen::Matrix2Xd& parameters,
                         const PointMask& mask,
                         double length_u,
                         double length_v) {
  const auto count = static_cast<double>(std::max<Eigen::Index>(1, mask.count()));
  const double side = std::sqrt(length_u * length_v * kPointsOfATile / count);
  const auto tiles = [&](double length) {
    return std::max(1, static_cast<int>(std::min(length / side, count / kPointsOfATile)));
  };
  const int nu = tiles(length_u), nv = tiles(length_v);
  const auto tile = [](double at, double length, int n) {
    return static_cast<size_t>(std::clamp(static_cast<int>(n * at / length), 0, n - 1));
  };
  std::vector<bool> full(static_cast<size_t>(nu) * static_cast<size_t>(nv), false);
  for (Eigen::Index k = 0; k < mask.size(); ++k) {
    if (!mask[k]) continue;
    full[tile(parameters(0, k), length_u, nu) * static_cast<size_t>(nv) +
         tile(parameters(1, k), length_v, nv)] = true;
  }
  const auto filled = static_cast<double>(std::count(full.begin(), full.end(), true));
  return 1 - filled / static_cast<double>(full.size());
}

}  // namespace batten::internal
