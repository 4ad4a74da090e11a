// SPDX-License-Identifier: MIT
// Cylindrical parameters of a cloud: angle round an axis and length along a profile.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "batten/geometry/thread_pool.h"
#include "fitting/revolution/revolution_axis.h"
#include "fitting/revolution/revolution_samples.h"
#include "fitting/revolution/round_cloud.h"
#include "fitting/revolution/round_parameters.h"

namespace batten::internal {

// Cylindrical coordinates of the nodes and their normals' components in the half plane.
struct SamplesAboutAxis {
  Eigen::Matrix2Xd places;   // (r, z)
  Eigen::VectorXd angles;    // in (−π, π]
  Eigen::Matrix2Xd normals;  // of length 1; (1, 0) where a normal is tangential to the axis
  std::vector<bool> clear;   // far enough from the axis for its angle to be reliable
  double reach = 0;          // median of the nodes' reaches
  double mean_radius = 0;

  Eigen::Index size() const { return places.cols(); }
};
SamplesAboutAxis CylindricalCoordinates(const RevolutionSamples& round, const AxisFrame& frame);

// Reaches across the way round in which ClosedFraction looks for nodes.
inline constexpr double kChartBand = 4;

// Range of the angle round the axis that a shape covers.
struct WayRound {
  bool closed = false;
  double share = 0;            // share of the profile that is closed round the axis
  bool winds = false;          // goes round more than once without closing
  double start = 0, turn = 0;  // angles of the nodes' range, if it is not closed
};
WayRound FindWayRound(const RevolutionSamples& round,
                      const SamplesAboutAxis& seen,
                      const std::vector<double>& along,
                      double period);

// The chart in which parameters are measured: the axis, the range of angles and the profile.
struct CylindricalChart {
  AxisFrame frame;
  WayRound way;
  double mean_radius = 1;
  double reach = 0;                                     // between nodes
  double period = 0;                                    // of the profile, when it is closed
  std::function<double(const Eigen::Vector2d&)> along;  // length along the profile to (r, z)
  double low = 0, high = 0;                             // of the nodes
  std::optional<double> low_pole, high_pole;            // where the profile meets the axis
};

// Assigns the parameters, their ranges, and the ends that are poles: those whose points come within
// three of their spacings of the axis and leave no hole there.
void AssignParameters(const CylindricalChart& chart,
                      const RoundCloud& cloud,
                      ThreadPool& pool,
                      RevolutionParameterization& base);

}  // namespace batten::internal
