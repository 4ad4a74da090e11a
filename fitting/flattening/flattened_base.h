// SPDX-License-Identifier: MIT
// What the flattenings of a sheet and of a tube have in common.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "batten/fitting/cloud_statistics.h"
#include "batten/fitting/neighbours.h"
#include "fitting/flattening/arap_flattening.h"
#include "fitting/flattening/sheet_graph.h"

namespace batten::internal {

// Parameters of points, as lengths along a sheet, a rectangle or a tube, and how well it lies in
// the plane.
struct FlattenedBase {
  // 2 × m in [0, length_u] × [0, length_v]: a smooth function of the point.
  Eigen::Matrix2Xd parameters;
  PointMask reached;  // false where a point stands off the surface: its parameters are a guess
  double length_u = 0, length_v = 0;
  double distortion = 0;  // relative change of lengths, root mean square
  double folded = 0;      // share of the nodes at which the flattening is turned over
  double overlap = 0;     // share of the nodes that lie on another part of the flattened surface
  double share = 0;       // share of the nodes in the largest connected component
  bool orientation_consistent = true;  // false: one-sided, as a Möbius band
  std::string failure_reason;  // empty when the flattening serves, else why not and what to do

  bool ok() const { return failure_reason.empty(); }
};

// Measures of a flattening up to which it serves.
struct FlatteningLimits {
  double distortion = 0.4, folded = 0.002, overlap = 0.01;
};
inline constexpr FlatteningLimits kFlatteningLimits;

// Settings of one attempt.
struct FlatteningAttempt {
  PoissonDiskOptions nodes;
  SheetGraphOptions graph;
};

// Returns three attempts, each of a finer resolution and stricter edges than the one before.
std::vector<FlatteningAttempt> FlatteningAttempts();

struct FlattenedNodes {
  SheetGraph graph;
  Flattening unfolding;
};

// Contradicting edges whose ends lie apart that make a surface one-sided: a few are slips.
inline constexpr int kLeastTorn = 5;

// Returns the share of the nodes on which others lie, by the places given, that are far away in
// space. O(n log n).
double OverlapOf(const SheetGraph& graph, const Eigen::Matrix3Xd& plan);

// Returns why a graph that holds this share of the nodes is not all of a sheet.
std::string SeveralSheets(double share);

// Fills in parameters of points of what was not flattened.
void PutAnywhere(Eigen::Index count, double spacing, double margin, FlattenedBase& base);

// Throws std::invalid_argument in the name of `function` unless there are points and the rest fits
// them.
void CheckBaseInput(const std::string& function,
                    const Eigen::Matrix3Xd& points,
                    const NeighbourIndex& index,
                    double spacing,
                    double noise,
                    double margin);

}  // namespace batten::internal
