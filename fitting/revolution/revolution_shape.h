// SPDX-License-Identifier: MIT
// Fit of the axis and the mean profile of a surface of revolution.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "batten/geometry/thread_pool.h"
#include "fitting/revolution/base_profile.h"
#include "fitting/revolution/cylindrical_chart.h"
#include "fitting/revolution/revolution_samples.h"

namespace batten::internal {

struct RevolutionEstimate {
  AxisFrame frame;
  SamplesAboutAxis seen;               // the nodes about it
  std::optional<BaseProfile> profile;  // none if no profile was found
  bool closed_along = false;
  double low = 0, high = 0;  // range of the nodes' foot points, as parameters of the profile
  std::vector<double> feet;  // of the nodes
  double misfit = 0;         // distance of the nodes, root mean square, over their mean radius
};

// Fits axis and profile from the best of the axes estimated from the normals. The profile is
// integrated along the graph, its mean is fitted as a spline, and axis and profile are then refined
// together by least squares distances of the nodes. Robust against ripples along and round.
// O(nodes · spans).
RevolutionEstimate FindRevolution(const RevolutionSamples& round, ThreadPool& pool);

// Returns the shape found without a preferred axis, or the one about that axis if it is as good
// unchanged, as any axis of a sphere is.
RevolutionEstimate WithPreferredAxis(RevolutionEstimate found,
                                     const RevolutionSamples& round,
                                     const std::optional<AxisFrame>& preferred,
                                     ThreadPool& pool);

}  // namespace batten::internal
