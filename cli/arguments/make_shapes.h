// SPDX-License-Identifier: MIT
// The kinds of `batten make` that this version has: their flags, and the shapes made of them.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "batten/io/geometry_types.h"
#include "cli/terminal/cli11_forward.h"

namespace batten::internal {

// Values as they were typed; empty where there is no default.
struct MakeArguments {
  std::string center = "0,0,0", axis = "0,0,1", x_axis;
  std::string from, to, corner00, corner10, corner01, corner11, size;
  std::string radius, radii, major_radius, minor_radius, height, top_radius, half_angle;
  std::string start_angle = "0", sweep = "360", latitudes = "-90,90";
  std::string tube_start = "0", tube_sweep = "360";
  std::string curve, format;  // of revolve
};

struct MakeKind {
  const char* name;
  const char* what;      // help
  const char* examples;  // of what follows "batten make "
  void (*add_flags)(CLI::App& command, MakeArguments& arguments);
  std::vector<Geometry> (*make)(const MakeArguments& arguments);  // throws UsageError, ReadError
};

const std::vector<MakeKind>& MakeKinds();

}  // namespace batten::internal
