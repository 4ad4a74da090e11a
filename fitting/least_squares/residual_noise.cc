// SPDX-License-Identifier: MIT
#include "fitting/least_squares/residual_noise.h"

#include <algorithm>
#include <cstdint>
#include <numeric>

namespace batten::internal {
namespace {

constexpr int kBits = 16;
constexpr size_t kLags = 4;  // neighbours that each datum is compared with

// Every second bit of the result is one of the lowest 16 bits of x.
std::uint64_t Spread(std::uint64_t x) {
  std::uint64_t spread = 0;
  for (int bit = 0; bit < kBits; ++bit) spread |= (x >> bit & 1) << (2 * bit);
  return spread;
}

}  // namespace

ResidualNoise::ResidualNoise(const Eigen::Matrix2Xd& parameters) {
  const Eigen::Index count = parameters.cols();
  order_.resize(static_cast<size_t>(count));
  std::iota(order_.begin(), order_.end(), Eigen::Index{0});
  if (count < 2) return;
  const Eigen::Vector2d low = parameters.rowwise().minCoeff();
  const Eigen::Vector2d size = parameters.rowwise().maxCoeff() - low;
  std::vector<std::uint64_t> key(order_.size());
  for (Eigen::Index k = 0; k < count; ++k) {
    for (int d = 0; d < 2; ++d) {
      if (!(size[d] > 0)) continue;
      const double share = std::clamp((parameters(d, k) - low[d]) / size[d], 0.0, 1.0);
      key[static_cast<size_t>(k)] |= Spread(static_cast<std::uint64_t>(share * ((1 << kBits) - 1)))
                                     << d;
    }
  }
  const bool line = !(size[1] > 0);  // finer than the key's bits
  std::sort(order_.begin(), order_.end(), [&](Eigen::Index a, Eigen::Index b) {
    if (line && parameters(0, a) != parameters(0, b)) return parameters(0, a) < parameters(0, b);
    const std::uint64_t ka = key[static_cast<size_t>(a)], kb = key[static_cast<size_t>(b)];
    return ka != kb ? ka < kb : a < b;
  });
}

// With variances s/w_i and s/w_j the squared difference has the mean s (1/w_i + 1/w_j).
double ResidualNoise::Variance(const Eigen::MatrixXd& residuals,
                               const Eigen::VectorXd& weights) const {
  double squares = 0, pairs = 0;
  for (size_t k = 1; k < order_.size(); ++k) {
    for (size_t lag = 1; lag <= std::min(k, kLags); ++lag) {
      const Eigen::Index i = order_[k - lag], j = order_[k];
      const double wi = weights.size() > 0 ? weights[i] : 1,
                   wj = weights.size() > 0 ? weights[j] : 1;
      if (!(wi > 0) || !(wj > 0)) continue;
      squares += (residuals.col(i) - residuals.col(j)).squaredNorm() / (1 / wi + 1 / wj);
      pairs += 1;
    }
  }
  return pairs > 0 ? squares / pairs : 0.0;
}

}  // namespace batten::internal
