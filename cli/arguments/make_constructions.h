// SPDX-License-Identifier: MIT
// The kinds of `batten make` that make surfaces of curves in files: their flags, and the surfaces.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "batten/io/geometry_types.h"
#include "cli/arguments/shared_unit.h"
#include "cli/terminal/cli11_forward.h"

namespace batten::internal {

// Values as they were typed; empty where there is no default.
struct ConstructionArguments {
  std::vector<std::string> curves, along_u, along_v;  // files
  std::string spine, format;
  std::string by, tolerance, degree = "3", start_tangent, end_tangent, twist = "0", scale = "1";
  std::string center = "0,0,0", axis = "0,0,1", x_axis;
  std::string corner00, corner10, corner01, corner11, tangents_u, tangents_v, twists;
  std::shared_ptr<SharedUnit> unit = std::make_shared<SharedUnit>();  // of the files
  bool by_length = false, align = false, closed = false, translational = false, bicubic = false;
};

// What is made, and what there is to say about it.
struct Construction {
  std::vector<Geometry> shapes;
  std::vector<std::string> notes = {};
};

struct ConstructionKind {
  const char* name;
  const char* what;      // help
  const char* examples;  // of what follows "batten make "
  void (*add_flags)(CLI::App& command, ConstructionArguments& arguments);
  Construction (*make)(const ConstructionArguments& arguments);  // throws UsageError, ReadError
};

const std::vector<ConstructionKind>& ConstructionKinds();

}  // namespace batten::internal
