// SPDX-License-Identifier: MIT
// The road of clouds of which a sample and sums over places are held.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "batten/fitting/stream_options.h"
#include "batten/fitting/surface_options.h"
#include "fitting/core/stage_clock.h"
#include "fitting/streaming/all_distances.h"
#include "fitting/streaming/first_look.h"
#include "fitting/streaming/near_surface.h"
#include "fitting/streaming/place_sums.h"
#include "fitting/streaming/point_passes.h"
#include "fitting/streaming/sample_fit.h"
#include "fitting/surface/fit_over_base.h"

namespace batten::internal {

// Throws std::invalid_argument naming the option that needs all points in memory.
void RefuseWhatNeedsAllPoints(const SurfaceFitOptions& options);

// How far the surface that points are placed by goes on beyond the sample, in its spacings.
inline constexpr double kRoomInSpacings = 4;

// What noise leaves of the tolerance for the shape: the greatest of m normal errors is about
// √(2 ln m) of them. All of it where that is more: it can't be kept.
std::optional<double> ToleranceOfShape(const std::optional<double>& tolerance,
                                       double noise,
                                       double count);

// How much is held, and when the pipeline stops.
struct StreamLimits {
  double first_places;   // in the first round
  double most_places;    // ever
  bool stops_in_passes;  // as progress asks; else only between passes, with what there is
};

// The points summed place by place.
struct PlacedSums {
  PlaceSums::Means means;
  double noise = 0, limit = 0;  // of points: the distance at which outliers begin
};

// A fit over places, not yet measured.
struct PlacesFit {
  PreparedCloud prepared;  // the means of the places
  FittedState fitted;
  PlacedSums sums;
  bool coarse = false;  // fewer places to a control point than the means of places ask for
};

// A surface before all points are measured.
struct UnmeasuredFit {
  NurbsSurface surface;  // in world coordinates less options.shift
  FitReport report;
  Parameterization base;
  double noise = 0, limit = 0;  // of points: the distance at which outliers begin
  EndCode search = EndCode::kCrossValidated;
  bool coarse = false;
};

// Gets the feet and distances of the points, in the order of the pass; merge and numbers as
// StreamPipeline::Pass has them, of what it makes of them.
struct TakeDistances {
  std::function<void(const PointDistances& found)> take = {};
  std::function<void()> merge = {};
  std::vector<std::span<double>> numbers = {};
};

class StreamPipeline {
 public:
  // `look`: what the first of the passes told. `options` free nothing for a joint stage.
  StreamPipeline(PointPasses& passes,
                 const SurfaceFitOptions& options,
                 const StreamLimits& limits,
                 FirstLook look,
                 ThreadPool& pool,
                 StageClock& clock);

  const FirstLook& look() const { return look_; }
  const SampleFit& sample() const { return sample_; }
  PointSource& source() const { return passes_.source(); }

  // The next pass, of whose points, in world coordinates, all tell `numbers` in the end: `merge`
  // brings those of other processes in.
  void Pass(const char* stage,
            const std::vector<std::span<double>>& numbers,
            const TakePoints& take,
            const std::function<void()>& merge);
  // In the sample's coordinates.
  Eigen::Matrix3Xd Local(const Eigen::Matrix3Xd& points) const;

  // Places the points, sums them and solves over the places until these are fine enough, then trims
  // the surface.
  PlacesFit Solve();

  // Passes over the points to measure them.
  StreamedFit Measured(PlacesFit places, const TakeDistances& take = {});
  StreamedFit Measured(UnmeasuredFit fit, const TakeDistances& take = {});

 private:
  PlacedSums Summed(const NearSurface& near, double places);
  SurfaceFitOptions OptionsOfPlaces(double noise) const;
  bool IsFar(const NearSurface& near, const PlacesFit& fit);
  void Trim(PlacesFit& fit);
  void Complete(const UnmeasuredFit& fit, const AllDistances& all, StreamedFit& result) const;

  PointPasses& passes_;
  const SurfaceFitOptions options_;
  const StreamLimits limits_;
  const FirstLook look_;
  ThreadPool& pool_;
  StageClock& clock_;
  SampleFit sample_;
};

}  // namespace batten::internal
