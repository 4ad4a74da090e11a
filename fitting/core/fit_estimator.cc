// SPDX-License-Identifier: MIT
#include "batten/fitting/fit_estimator.h"

#include <stdexcept>

#include "fitting/core/mask_indices.h"

namespace batten {

std::vector<Eigen::Index> FitEstimator::UsedPoints(const PointMask& outliers,
                                                   Eigen::Index count) const {
  if (!refused.empty()) throw std::invalid_argument("Uncertainty: fit: " + refused);
  if (outliers.size() != count)
    throw std::invalid_argument("Uncertainty: cloud: it has " + std::to_string(count) +
                                " points, the fit " + std::to_string(outliers.size()));
  return internal::IndicesOf(used.size() > 0 ? used : PointMask(!outliers));
}

}  // namespace batten
