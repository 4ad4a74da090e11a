// SPDX-License-Identifier: MIT
// View of an Eigen vector's values as a std::span.
#pragma once

#include <Eigen/Core>
#include <span>

namespace batten::internal {

inline std::span<const double> Values(const Eigen::VectorXd& t) {
  return {t.data(), static_cast<size_t>(t.size())};
}

}  // namespace batten::internal
