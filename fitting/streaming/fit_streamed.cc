// SPDX-License-Identifier: MIT
#include "batten/fitting/fit_streamed.h"

#include <stdexcept>
#include <string>
#include <utility>

#include "batten/fitting/fit_surface.h"
#include "fitting/streaming/sample_warnings.h"
#include "fitting/streaming/stream_pipeline.h"

namespace batten {
using namespace internal;
namespace {

// Of FitSurface, and of a place with its solution: resident memory at 10^7 points, 10^6 places.
constexpr double kBytesOfPoint = 250, kBytesOfPlace = 600;
constexpr double kFirstPlaces = 250000;

StreamedFit InMemory(PointSource& source, const SurfaceFitOptions& options, double count) {
  const auto differ = [] {
    return std::runtime_error("the source gave other points than in its first pass");
  };
  Eigen::Matrix3Xd points(3, static_cast<Eigen::Index>(count));
  Eigen::Index at = 0;
  source.Pass([&](const Eigen::Matrix3Xd& some) {
    if (at + some.cols() > points.cols()) throw differ();
    points.middleCols(at, some.cols()) = some;
    at += some.cols();
  });
  if (at != points.cols()) throw differ();
  PointCloud cloud = PointCloud::FromWorld(std::move(points));
  SurfaceFit fit = FitSurface(cloud, options);
  return {std::move(fit.surface),
          std::move(fit.report),
          std::move(cloud),
          std::move(fit.parameters),
          std::move(fit.residuals),
          std::move(fit.outliers),
          true,
          2};
}

}  // namespace

StreamedFit FitStreamed(PointSource& source,
                        const SurfaceFitOptions& options,
                        const StreamOptions& stream) {
  Check(options);
  Check(stream);
  RefuseWhatNeedsAllPoints(options);
  StageClock clock(&StageSeconds::read);
  PointPasses passes(source, stream.store, options.threads != 1);
  FirstLook look = TakeFirstLook(passes, stream.sample, options.seed, options.progress);
  if (!source.shared() && kBytesOfPoint * look.count <= static_cast<double>(stream.memory))
    return InMemory(source, options, look.count);
  SurfaceFitOptions plain = options;
  plain.optimize = FreeVariables{};
  ThreadPool pool(options.threads);
  const StreamLimits limits{kFirstPlaces, static_cast<double>(stream.memory) / kBytesOfPlace, true};
  StreamPipeline pipeline(passes, plain, limits, std::move(look), pool, clock);
  StreamedFit fit = pipeline.Measured(pipeline.Solve());
  WarnOfParts(fit.sample, pool, fit.report);
  return fit;
}

}  // namespace batten
