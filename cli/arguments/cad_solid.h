// SPDX-License-Identifier: MIT
// The solid of a machined part: which road a solid takes, and the one over exact faces.
#pragma once

#include <optional>
#include <string>

#include "cli/arguments/fit_arguments.h"

namespace batten::internal {

enum class SolidKind { kAuto, kCad, kOrganic };

SolidKind ToSolidKind(const std::string& word);

// Takes the road over planes, cylinders, cones, spheres and tori, and returns the exit code. None
// where kAuto has to take the other, which is said with the reason; kCad refuses instead.
std::optional<int> RunCadSolid(const FitArguments& arguments,
                               SolidKind kind,
                               FitFiles& files,
                               const PointCloud& cloud);

}  // namespace batten::internal
