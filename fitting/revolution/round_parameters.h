// SPDX-License-Identifier: MIT
// Parameters of a cloud over a round base: angle round an axis and length along a profile.
#pragma once

#include <Eigen/Core>
#include <string>

namespace batten::internal {

struct RevolutionParameterization {
  std::string name;  // "revolution", "sphere", "torus"
  // 2 × m: u the angle round the axis times the mean radius, v the length along the profile, in
  // [0, length_u] × [0, length_v] (below a length where it is periodic). Smooth functions of the
  // point off the axis; u × v looks outwards.
  Eigen::Matrix2Xd parameters;
  double length_u = 0, length_v = 0;
  bool periodic_u = false, periodic_v = false;  // the direction is closed
  bool pole_start = false, pole_end = false;    // the edge v = 0 (v = length_v) is one point
  double turn = 0;                              // angle swept over length_u
  double misfit = 0;  // distance of the nodes from the base, root mean square, over the mean radius
  std::string why;    // one clause for the report
  std::string failure_reason;  // empty when the base serves, else why not and what to do

  bool ok() const { return failure_reason.empty(); }
};

}  // namespace batten::internal
