// SPDX-License-Identifier: MIT
// The road of clouds of which a sample and sums over places are held.
#pragma once

#include <cstdint>
#include <functional>

#include "batten/fitting/point_source.h"
#include "batten/fitting/stream_options.h"
#include "batten/fitting/surface_options.h"
#include "fitting/core/stage_clock.h"
#include "fitting/streaming/all_distances.h"
#include "fitting/streaming/first_look.h"
#include "fitting/streaming/near_surface.h"
#include "fitting/streaming/place_sums.h"
#include "fitting/streaming/sample_fit.h"
#include "fitting/surface/fit_over_base.h"

namespace batten::internal {

// Throws std::invalid_argument naming the option that needs all points in memory.
void RefuseWhatNeedsAllPoints(const SurfaceFitOptions& options);

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

class StreamPipeline {
 public:
  // `look`: what the first pass told, of `passes` so far.
  // `options` free nothing for a joint stage.
  StreamPipeline(PointSource& source,
                 const SurfaceFitOptions& options,
                 const StreamLimits& limits,
                 FirstLook look,
                 int passes,
                 ThreadPool& pool,
                 StageClock& clock);

  const SampleFit& sample() const { return sample_; }
  int passes() const { return passes_; }

  // Places the points, sums them and solves over the places until these are fine enough, then trims
  // the surface.
  PlacesFit Solve();

  // Gets the feet and distances of the points, in the order of the pass.
  using TakeDistances = std::function<void(const PointDistances& found)>;

  // Passes over the points to measure them.
  StreamedFit Measured(PlacesFit places, const TakeDistances& take = {});

 private:
  void Pass(const char* stage, const TakePoints& take);
  Eigen::Matrix3Xd Local(const Eigen::Matrix3Xd& points) const;
  PlacedSums Summed(const NearSurface& near, double places);
  SurfaceFitOptions OptionsOfPlaces(double noise) const;
  bool IsFar(const NearSurface& near, const PlacesFit& fit);
  void Trim(PlacesFit& fit);
  void Complete(const PlacesFit& places,
                const AllDistances& all,
                EndCode search,
                StreamedFit& result) const;
  void WarnOfWhatTheSampleMisses(const AllDistances& all, StreamedFit& result) const;

  PointSource& source_;
  const SurfaceFitOptions options_;
  const StreamLimits limits_;
  const FirstLook look_;
  int passes_;
  ThreadPool& pool_;
  StageClock& clock_;
  SampleFit sample_;
};

}  // namespace batten::internal
