// SPDX-License-Identifier: MIT
#include "fitting/streaming/fit_by_sums.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "batten/fitting/refused_data.h"
#include "fitting/core/shared_constants.h"
#include "fitting/streaming/stream_pipeline.h"

namespace batten::internal {
namespace {

constexpr double kFirstSums = 100000;

// The points of a cloud, in world coordinates.
class CloudSource : public PointSource {
 public:
  explicit CloudSource(const PointCloud& cloud) : cloud_(cloud) {}
  void Pass(const TakePoints& take) override {
    const Eigen::Index piece = kPointsOfPiece;
    for (Eigen::Index at = 0; at < cloud_.size(); at += piece)
      take(cloud_.points().middleCols(at, std::min(piece, cloud_.size() - at)).colwise() +
           cloud_.origin());
  }

 private:
  const PointCloud& cloud_;
};

// Whether nothing asks for more than the points' places: what is passed over has no weights.
bool NeedsOnlySums(const PointCloud& cloud, const SurfaceFitOptions& options) {
  if (cloud.weights().size() > 0) return false;
  try {
    RefuseWhatNeedsAllPoints(options);
  } catch (const std::invalid_argument&) {
    return false;
  }
  return true;
}

std::optional<SurfaceFit> Fitted(const PointCloud& cloud,
                                 const SurfaceFitOptions& options,
                                 Eigen::Index sample,
                                 ThreadPool& pool,
                                 StageClock& clock) {
  SurfaceFitOptions plain = options;
  plain.optimize = FreeVariables{};
  CloudSource source(cloud);
  PointPasses passes(source, nullptr, false);
  StreamPipeline pipeline(passes,
                          plain,
                          StreamLimits{kFirstSums, static_cast<double>(cloud.size()) / 2, false},
                          TakeFirstLook(passes, sample, options.seed, options.progress),
                          pool,
                          clock);
  if (!pipeline.sample().clean) return std::nullopt;
  PlacesFit places = pipeline.Solve();
  if (places.sums.means.set_aside > 0 || places.fitted.draft.surface.trimmed()) return std::nullopt;
  FitEstimator estimator = places.fitted.draft.estimator;
  Eigen::Matrix2Xd parameters(2, cloud.size());
  Eigen::VectorXd residuals(cloud.size());
  Eigen::Index at = 0;
  StreamedFit fit = pipeline.Measured(std::move(places), {[&](const PointDistances& found) {
                                        const Eigen::Index count = found.distances.size();
                                        parameters.middleCols(at, count) = found.parameters;
                                        residuals.segment(at, count) = found.distances;
                                        at += count;
                                      }});
  FitReport& report = fit.report;
  if (report.termination != Termination::kNoiseReached &&
      report.termination != Termination::kToleranceReached &&
      report.termination != Termination::kCancelled)
    return std::nullopt;
  report.error = report.error_all = Summarise(residuals, options.tolerance);
  report.optimize.why = options.optimize ? "not asked for" : "residuals are at the noise";
  report.input.origin = cloud.origin();
  estimator.shift = options.shift;
  return SurfaceFit{std::move(fit.surface),
                    std::move(parameters),
                    std::move(residuals),
                    PointMask::Constant(cloud.size(), false),
                    std::move(report),
                    std::move(estimator)};
}

}  // namespace

std::optional<SurfaceFit> FitBySums(const PointCloud& cloud,
                                    const SurfaceFitOptions& options,
                                    Eigen::Index sample,
                                    StageClock& clock) {
  if (!NeedsOnlySums(cloud, options)) return std::nullopt;
  ThreadPool pool(options.threads);
  try {
    return Fitted(cloud, options, sample, pool, clock);
  } catch (const RefusedData&) {
    return std::nullopt;  // all points may tell more, or why not
  }
}

}  // namespace batten::internal
