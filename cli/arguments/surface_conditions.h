// SPDX-License-Identifier: MIT
// Flags that say what a fitted surface is to meet exactly.
#pragma once

#include <string>
#include <vector>

#include "batten/fitting/fit_surface.h"
#include "cli/terminal/cli11_forward.h"

namespace batten::internal {

struct ConditionArguments {
  std::vector<std::string> boundary;
  std::string boundary_tolerance = "0", meet, symmetric, domain;
  // What is read for them.
  std::vector<std::string> Files() const {
    std::vector<std::string> files = boundary;
    if (!meet.empty()) files.push_back(meet);
    return files;
  }
  bool any() const { return !boundary.empty() || !meet.empty() || !symmetric.empty(); }
};
void AddConditionArguments(CLI::App& command, ConditionArguments& arguments);

// Reads the files and values into the options. Throws UsageError naming the flag, the value and the
// rule; ReadError for a file that can't be used.
void TakeConditions(const ConditionArguments& arguments, SurfaceFitOptions& options);

// x, y, z (the plane where that coordinate is 0) or a,b,c,d (a·x + b·y + c·z + d = 0).
MirrorPlane ParsePlane(const std::string& flag, const std::string& text);

}  // namespace batten::internal
