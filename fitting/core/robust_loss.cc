// SPDX-License-Identifier: MIT
#include "batten/fitting/robust_loss.h"

#include <cmath>
#include <vector>

#include "batten/fitting/statistics.h"
#include "fitting/core/shared_constants.h"

namespace batten {
using internal::kTruncatedTuning;
using internal::kTukeyTuning;
namespace {

constexpr double kHuberTuning = 1.345, kCauchyTuning = 2.385;

}  // namespace

bool ForgetsFarPoints(Loss loss) { return loss == Loss::kTukey || loss == Loss::kTruncated; }

double LossValue(Loss loss, double residual, double scale) {
  const double r = std::abs(residual);
  if (loss == Loss::kNone || !(scale > 0)) return r * r / 2;
  switch (loss) {
    case Loss::kNone:
      break;
    case Loss::kHuber: {
      const double knee = kHuberTuning * scale;
      return r <= knee ? r * r / 2 : knee * (r - knee / 2);
    }
    case Loss::kCauchy: {
      const double c = kCauchyTuning * scale;
      return c * c / 2 * std::log1p((r / c) * (r / c));
    }
    case Loss::kTukey: {
      const double c = kTukeyTuning * scale;
      if (r >= c) return c * c / 6;
      const double t2 = (r / c) * (r / c);
      return r * r / 2 * (1 - t2 + t2 * t2 / 3);  // c²/6 (1 − (1 − t²)³) without its cancellation
    }
    case Loss::kTruncated: {
      const double c = kTruncatedTuning * scale;
      return r < c ? r * r / 2 : c * c / 2;
    }
  }
  return r * r / 2;
}

double LossWeight(Loss loss, double residual, double scale) {
  const double r = std::abs(residual);
  if (!(scale > 0)) return 1;  // exact data: nothing to bound
  switch (loss) {
    case Loss::kNone:
      return 1;
    case Loss::kHuber: {
      const double knee = kHuberTuning * scale;
      return r <= knee ? 1 : knee / r;
    }
    case Loss::kCauchy: {
      const double t = r / (kCauchyTuning * scale);
      return 1 / (1 + t * t);
    }
    case Loss::kTukey: {
      const double t = r / (kTukeyTuning * scale);
      return t < 1 ? (1 - t * t) * (1 - t * t) : 0;
    }
    case Loss::kTruncated:
      return r < kTruncatedTuning * scale ? 1 : 0;
  }
  return 1;
}

Eigen::VectorXd LossWeights(Loss loss, const Eigen::VectorXd& residuals, double scale) {
  return residuals.unaryExpr([&](double r) { return LossWeight(loss, r, scale); });
}

double RobustScale(const Eigen::VectorXd& residuals) {
  std::vector<double> magnitudes(residuals.begin(), residuals.end());
  for (double& r : magnitudes) r = std::abs(r);
  return kMadToSigma * Median(std::move(magnitudes));
}

}  // namespace batten
