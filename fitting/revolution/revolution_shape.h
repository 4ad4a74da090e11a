// SPDX-License-Identifier: MIT
// The axis and the mean profile of a shape of revolution.
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
  std::optional<BaseProfile> profile;  // none where nothing could be found
  bool closed_along = false;
  double low = 0, high = 0;  // of the nodes' feet, parameters of the profile
  std::vector<double> feet;  // of the nodes
  double misfit = 0;         // distance of the nodes, root mean square, over their mean radius
};

// The best of the axes that normals give, or the one preferred where it is as good as it stands, as
// any axis of a sphere is: the profile is integrated along
// the graph, its mean fitted as a spline, and axis and profile then changed together so that the
// nodes are nearest. Robust against ripples along and round. O(nodes · spans).
RevolutionEstimate FindRevolution(const RevolutionSamples& round,
                                  const std::optional<AxisFrame>& preferred,
                                  ThreadPool& pool);

// What was found about no preferred axis, or the shape about that axis where it is as good.
RevolutionEstimate WithPreferredAxis(RevolutionEstimate found,
                                     const RevolutionSamples& round,
                                     const std::optional<AxisFrame>& preferred,
                                     ThreadPool& pool);

}  // namespace batten::internal
