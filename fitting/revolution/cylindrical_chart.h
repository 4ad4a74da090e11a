// SPDX-License-Identifier: MIT
// Angle round an axis and length along a profile as the parameters of a cloud.
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

// Cylinder coordinates of the nodes and the part of their normals in the half plane.
struct SamplesAboutAxis {
  Eigen::Matrix2Xd places;   // (r, z)
  Eigen::VectorXd angles;    // in (−π, π]
  Eigen::Matrix2Xd normals;  // of length 1; (1, 0) where a normal runs round the axis
  std::vector<bool> clear;   // far enough from the axis for its angle to tell something
  double reach = 0;          // their median
  double mean_radius = 0;

  Eigen::Index size() const { return places.cols(); }
};
SamplesAboutAxis CylindricalCoordinates(const RevolutionSamples& round, const AxisFrame& frame);

// Steps of the angle along the edges, each the short way.
std::vector<double> AngleSteps(const RevolutionSamples& round, const Eigen::VectorXd& angles);

// How far round the axis a shape goes.
struct WayRound {
  bool closed = false;
  double share = 0;            // of the profile's places that are gone round wholly
  bool winds = false;          // more than once round without closing
  double start = 0, turn = 0;  // of the nodes, where it is not closed
};
WayRound FindWayRound(const RevolutionSamples& round,
                      const SamplesAboutAxis& seen,
                      const std::vector<double>& along,
                      double period,
                      double least_closed);

// What parameters are measured on.
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

// Fills in the parameters, their ranges, and which ends are poles: those whose points come within
// three of their spacings of the axis, and no nearer to a hole.
void AssignParameters(const CylindricalChart& chart,
                      const RoundCloud& cloud,
                      ThreadPool& pool,
                      RevolutionParameterization& base);

}  // namespace batten::internal
