// SPDX-License-Identifier: MIT
// Surfaces of the connected parts of a cloud.
#pragma once

#include <optional>
#include <string>

#include "batten/fitting/surface_options.h"
#include "cli/arguments/fit_arguments.h"

namespace batten::internal {

// Which parts: one by its number, 1 the one of most points, or all.
struct PartChoice {
  bool all = false;
  std::optional<int> number = std::nullopt;

  bool asked() const { return all || number; }
};

// "whole" (none), "all" or a number. Throws UsageError for anything else.
PartChoice ToPartChoice(const std::string& text);

// Fits a surface to each part asked for and writes them into one file with one report, which lists
// the parts. Of all parts those that can't be fitted are listed with the reason. Returns the exit
// code.
int RunPartsFit(FitFiles& files,
                const PointCloud& cloud,
                const SurfaceFitOptions& options,
                const PartChoice& choice);

// A fit in little time, for where time is up before there is any.
SurfaceFitOptions QuickOptions(SurfaceFitOptions options, const PointCloud& cloud);

}  // namespace batten::internal
