// SPDX-License-Identifier: MIT
#include "batten/fitting/fit_estimator.h"

#include <stdexcept>

namespace batten {

std::vector<Eigen::Index> FitEstimator::UsedPoints(const PointMask& outliers,
                                                   Eigen::Index count) const {
  if (!refused.empty()) throw std::invalid_argument("Uncertainty: fit: " + refused);
  if (outliers.size() != count)
    throw std::invalid_argument("Uncertainty: cloud: it has " + std::to_string(count) +
                                " points, the fit " + std::to_string(outliers.size()));
  std::vector<Eigen::Index> indices;
  for (Eigen::Index k = 0; k < count; ++k)
    if (used.size() > 0 ? used[k] : !outliers[k]) indices.push_back(k);
  return indices;
}

}  // namespace batten
