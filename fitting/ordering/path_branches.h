// SPDX-License-Identifier: MIT
// Selection of the node paths that are curves, and detection of branches.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "fitting/ordering/node_paths.h"

namespace batten::internal {

// Returns the paths that are curves: at least five nodes (four when closed), not jagged, their
// nodes about as close as those of the others. A single path is always kept. Longest first, as
// given.
std::vector<NodePath> CurvesAmong(const std::vector<NodePath>& paths,
                                  const Eigen::Matrix3Xd& nodes);

// The mean angle by which the paths turn at a node. Small along curves, above 1 where nodes are
// scattered across one.
double MeanTurn(const std::vector<NodePath>& paths, const Eigen::Matrix3Xd& nodes);

// Finds the places where paths meet: an end within two links of another stretch, or two stretches
// within 1.2 of one. Stretches that run together from a sharp corner do not meet there. Every place
// where the rule holds, along the longest path first; empty where the paths are simple curves
// apart.
std::vector<Eigen::Vector3d> MeetingPlaces(const std::vector<NodePath>& paths,
                                           const Eigen::Matrix3Xd& nodes);

}  // namespace batten::internal
