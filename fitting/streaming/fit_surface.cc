// SPDX-License-Identifier: MIT
#include "batten/fitting/fit_surface.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "fitting/streaming/fit_by_sums.h"
#include "fitting/surface/fit_in_memory.h"

namespace batten {
using namespace internal;
namespace {

constexpr Eigen::Index kMostSampled = 100000;
constexpr Eigen::Index kManyPoints = 200000;  // fewer: the sample's own fit is no gain

}  // namespace

SurfaceFit FitSurface(const PointCloud& cloud, const SurfaceFitOptions& options) {
  Check(options);
  StageClock clock;
  std::optional<SurfaceFit> by_sums;
  if (cloud.size() >= kManyPoints)
    by_sums = FitBySums(cloud, options, std::min(kMostSampled, cloud.size() / 4), clock);
  clock.Enter(&StageSeconds::prepare);
  SurfaceFit fit = by_sums ? *std::move(by_sums) : FitInMemory(cloud, options, clock);
  fit.report.seconds = clock.Seconds();
  return fit;
}

}  // namespace batten
