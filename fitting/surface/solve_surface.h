// SPDX-License-Identifier: MIT
// From classified points to a surface: by their noise, by a tolerance, under conditions.
#pragma once

#include <string>
#include <vector>

#include "fitting/surface/inlier_classification.h"

namespace batten::internal {

struct SolvedSurface {
  NurbsSurface surface;         // in the cloud's local coordinates
  Eigen::Matrix2Xd parameters;  // of the points used
  FittingProblem problem;       // the one last solved over, with the weights of the points
  EndCode end;                  // how the search for degrees of freedom ended
  std::vector<RoundSummary> rounds = {};
  std::vector<std::string> warnings = {};
};

// The surface of as many control points as the data carry, or of those asked for: knot lines are
// refined and pruned, smoothing is chosen from the data where the options say so, and coefficients
// stay within BoundsFromData.
SolvedSurface SolveToNoise(const FitContext& context, const ClassifiedPoints& points);

// The surface of few control points that keeps options.tolerance, or comes near it: knot lines are
// inserted where points are out (RefineToTolerance).
SolvedSurface RefineWithinTolerance(const FitContext& context, const ClassifiedPoints& points);

// Solves under the conditions over the bases of `solved`, which were chosen without them.
void MeetConditions(const FitContext& context, const PointMask& used, SolvedSurface& solved);

}  // namespace batten::internal
