// SPDX-License-Identifier: MIT
// A kind of `batten make`, and the values of its flags.
#pragma once

#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "batten/io/geometry_types.h"
#include "cli/arguments/shared_unit.h"
#include "cli/terminal/cli11_forward.h"

namespace batten::internal {

// Values as they were typed; empty where there is no default.
struct MakeArguments {
  std::string center = "0,0,0", axis = "0,0,1", x_axis;
  std::string from, to, corner00, corner10, corner01, corner11, size;
  std::string derivatives, second_derivatives;  // of hermite, beside ends
  std::string radius, radii, major_radius, minor_radius, height, top_radius, half_angle;
  std::string start_angle = "0", sweep = "360", latitudes = "-90,90";
  std::string tube_start = "0", tube_sweep = "360";
  std::string curve, format;                                          // of revolve
  std::shared_ptr<SharedUnit> unit = std::make_shared<SharedUnit>();  // of files
  std::string circle_form, segments;
  // Conics.
  std::string ends, tangents, point, rho, shoulder, points, implicit, via, control;
  // Blends and fills.
  std::vector<std::string> files;
  std::string first_end, second_end, continuity = "2", fullness = "1";
  std::string tolerance, angle_tolerance;  // of fills
};

struct MakeKind {
  const char* name;
  const char* what;      // help
  const char* examples;  // of what follows "batten make "
  void (*add_flags)(CLI::App& command, MakeArguments& arguments);
  std::vector<Geometry> (*make)(const MakeArguments& arguments);  // throws UsageError, ReadError
  // What is said of what was made, measured on it: an object; none where nothing is. A member
  // "tolerance_reached" that is false makes exit code 3.
  nlohmann::ordered_json (*tell)(const MakeArguments& arguments,
                                 const std::vector<Geometry>& made) = nullptr;
};

}  // namespace batten::internal
