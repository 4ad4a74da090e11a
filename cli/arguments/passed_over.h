// SPDX-License-Identifier: MIT
// Surface fits of files that are passed over, not read: --memory and --tiles.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "batten/fitting/surface_options.h"
#include "batten/fitting/tile_options.h"
#include "batten/io/checkpoint.h"
#include "cli/arguments/fit_arguments.h"

namespace batten::internal {

struct PassArguments {
  std::optional<std::int64_t> memory;
  std::string tiles;                // empty: none
  std::string tile_faces = "each";  // or one
  std::string checkpoint;           // a folder; empty: none
  JobWords job;                     // the flags given that the result follows from
  bool any() const { return memory || !tiles.empty(); }
};

void AddPassArguments(CLI::App& command, PassArguments& arguments);

// When the flags of the command are parsed.
JobWords JobOf(const CLI::App& command);

// Throws UsageError where they do not go together.
void CheckPassArguments(const PassArguments& arguments, const FitArguments& fit);

// auto, or numbers of tiles in u and v: N,M or NxM.
TileOptions ToTileOptions(const std::string& text);

// Fits and writes; returns the exit code.
int RunPassedOver(FitFiles& files,
                  const FitArguments& fit,
                  SurfaceFitOptions options,
                  const PassArguments& arguments);

}  // namespace batten::internal
