// SPDX-License-Identifier: MIT
#include "fitting/streaming/sample_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "batten/fitting/robust_loss.h"
#include "fitting/cloud/residual_outliers.h"
#include "fitting/surface/fit_over_base.h"
#include "fitting/surface/inlier_classification.h"

namespace batten::internal {
namespace {

// Where the sample has no outliers, points are none up to so many times its greatest distance: that
// of 10^12 normal errors is 1.7 times that of 10^5.
constexpr double kBeyondSample = 4;

}  // namespace

double SampleFit::SpacingOf(double points) const { return spacing * std::sqrt(distinct / points); }

double SampleFit::LimitOf(const Eigen::VectorXd& distances,
                          const SurfaceFitOptions& options) const {
  if (options.keep_outliers) return std::numeric_limits<double>::infinity();
  const double scale = options.loss_scale.value_or(RobustScale(distances));
  const double least = LeastOutlierDistance(scale, noise, spacing, options);
  return std::min(OutlierThreshold(distances, least),
                  std::max(least, kBeyondSample * distances.cwiseAbs().maxCoeff()));
}

SampleFit FitSample(const FirstLook& look,
                    SurfaceFitOptions options,
                    ThreadPool& pool,
                    StageClock& clock) {
  clock.Enter(&StageSeconds::prepare);
  options.tolerance.reset();
  PointCloud cloud = PointCloud::FromWorld(look.sample);
  PreparedCloud prepared = PrepareCloud(cloud, options, pool, clock);
  FittedState fitted = FitOverBase(prepared,
                                   options,
                                   StartReport(prepared, prepared.merged.cloud, 0, pool.threads()),
                                   pool,
                                   clock);
  return {.cloud = std::move(cloud),
          .base = std::move(prepared.base),
          .surface = std::move(fitted.draft.surface),
          .noise = prepared.statistics.noise,
          .spacing = prepared.statistics.spacing,
          .distinct = static_cast<double>(prepared.merged.cloud.size()),
          .clean = prepared.merged.duplicates == 0 && !fitted.doubted,
          .warnings = std::move(prepared.warnings),
          .candidates = std::move(prepared.candidates)};
}

}  // namespace batten::internal
