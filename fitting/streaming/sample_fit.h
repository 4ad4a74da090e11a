// SPDX-License-Identifier: MIT
// The fit of a sample: a base and a surface near all points, and where outliers begin.
#pragma once

#include <string>
#include <vector>

#include "batten/fitting/surface_options.h"
#include "batten/geometry/thread_pool.h"
#include "fitting/core/stage_clock.h"
#include "fitting/parameterization/parameterization.h"
#include "fitting/streaming/first_look.h"
#include "fitting/surface/surface_preparation.h"

namespace batten::internal {

struct SampleFit {
  PointCloud cloud;
  Parameterization base;
  NurbsSurface surface;  // in the sample's coordinates
  double noise = 0, spacing = 0;
  double distinct = 0;  // points of the sample
  bool clean = false;   // no point twice, none set aside or bounded
  std::vector<std::string> warnings;
  std::vector<BaseCandidate> candidates;

  // Between neighbours of all points.
  double SpacingOf(double points) const;
  // The distance at which outliers begin, by the distances of the sample from a surface: as
  // ClassifyInliers has it, but finite, so that what the sample does not show does not draw the
  // surface away.
  double LimitOf(const Eigen::VectorXd& distances, const SurfaceFitOptions& options) const;
};

// `options` without a joint stage. Throws as PrepareCloud does.
SampleFit FitSample(const FirstLook& look,
                    SurfaceFitOptions options,
                    ThreadPool& pool,
                    StageClock& clock);

}  // namespace batten::internal
