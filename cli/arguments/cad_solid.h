// SPDX-License-Identifier: MIT
// The solid of a machined part: which road a solid takes, and the one over exact faces.
#pragma once

#include <optional>
#include <string>

#include "cli/arguments/fit_arguments.h"

namespace batten::internal {

enum class SolidKind { kAuto, kCad, kOrganic };

SolidKind ToSolidKind(const std::string& word);

struct CadOutcome {
  std::optional<int> code;  // the exit code; none: nothing is written
  std::string reason;       // why kAuto has to take the other road
};

// Takes the road over planes, cylinders, cones, spheres and tori; kCad refuses where it ends before
// a solid. One that points do not show for more than `most_invented` of its area is none.
CadOutcome RunCadSolid(const FitArguments& arguments,
                       SolidKind kind,
                       double most_invented,
                       FitFiles& files,
                       const PointCloud& cloud);

}  // namespace batten::internal
