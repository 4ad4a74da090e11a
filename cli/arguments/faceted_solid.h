// SPDX-License-Identifier: MIT
// The solid of a mesh as it is: what is written where no exact or smooth solid is good.
#pragma once

#include "batten/fitting/closed_surface.h"
#include "cli/arguments/fit_arguments.h"

namespace batten::internal {

// More plane faces than that no CAD program works with.
inline constexpr int kMostFacets = 20000;

// Writes the plane faces of a closed mesh, with the vertices of the cloud that was read as the
// report's points, and returns the exit code. `why`: why it is not another solid, which makes it
// doubtful; empty: it was asked for.
int WriteFacetedSolid(const FitArguments& arguments,
                      FitFiles& files,
                      const ClosedSurface& mesh,
                      const PointCloud& cloud,
                      const std::string& why);

}  // namespace batten::internal
