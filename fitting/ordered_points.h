// SPDX-License-Identifier: MIT
// Points along a curve: their parameters, and what they say of themselves.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "batten/fitting/point_cloud.h"

namespace batten {

// Where the parameters of a curve's points come from.
enum class CurveParameterization {
  kGiven,        // the cloud's parameters, in their own range
  kUniform,      // equal steps on [0, 1]
  kChord,        // steps in proportion to the distance of neighbours, on [0, 1]
  kCentripetal,  // to its square root, on [0, 1] [Lee 1989]
};

// The word reports use, as in "chord".
const char* Name(CurveParameterization parameterization);

// Points in increasing order of their parameters. Points in a row that agree in place, and in
// parameter where that is given, are one point with their weights added.
struct OrderedPoints {
  PointCloud cloud;
  Eigen::VectorXd parameters;
  std::vector<Eigen::Index> place;  // for every point given, the one that stands for it
  Eigen::Index repeats = 0;         // points that vanished into another
  double spacing = 0;               // mean distance of neighbours in this order
  // Standard deviation across the curve, from each point's distance to the cubic through two
  // neighbours on either side; their median, so that single points do not count. 0 below 12 points.
  double noise = 0;
};

// Given parameters may come in any order unless `keep_order` is set: then they must not decrease.
// All others follow the order of the points; where these lie closer than their noise allows to tell
// apart, steps are those of means of several in a row, and even inside. Throws
// std::invalid_argument, with a sentence for the user, where there are fewer than two different
// points, parameters are missing, all equal, too close together for their size to be told apart, or
// decrease where they must not; and where points differ by less than 1e-100 or parameters by less
// than 1e-60. O(m log m). [Piegl & Tiller 1997, §9.2.1]
OrderedPoints OrderPoints(const PointCloud& cloud,
                          CurveParameterization parameterization,
                          bool keep_order = false);

}  // namespace batten
