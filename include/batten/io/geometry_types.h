// SPDX-License-Identifier: MIT
// What a geometry file holds, how it is read, and how it is written.
#pragma once

#include <string>
#include <variant>
#include <vector>

#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"

namespace batten {

// What a geometry file holds.
using Geometry = std::variant<NurbsCurve<2>, NurbsCurve<3>, NurbsSurface>;

struct GeometryReadOptions {
  std::string format = {};  // "json", "step" or "iges"; empty: by the path's extension
  std::string unit = {};    // what coordinates are turned into, of length_unit.h; empty: the file's
};

// Everything a geometry file says.
struct GeometryContents {
  std::vector<Geometry> geometry;  // in the file's order; at least one
  std::vector<std::string> names;  // of each, UTF-8 on one line; empty where the file gives none
  std::string unit;                // of the coordinates; empty: the file does not say
  std::vector<std::string> remarks = {};  // what was not quite as it should be, a sentence each
};

struct GeometryWriteOptions {
  std::string format = {};            // "json", "step" or "iges"; empty: by the path's extension
  std::string unit = "mm";            // of the coordinates: declared, never scaled
  std::string step_schema = "ap214";  // or "ap242": the application protocol of STEP
};

// What becomes a geometry file.
struct GeometryFile {
  std::string path;
  std::vector<Geometry> geometry;
  std::vector<std::string> names = {};  // of each, where there are any; empty: no name of its own
};

}  // namespace batten
