// SPDX-License-Identifier: MIT
// What commands that write geometry say of each file.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "batten/io/geometry_types.h"

namespace batten::internal {

// {"path", "kind": "curve" | "surface" | "mixed", "degree", "control_points", "count"}; degree and
// control points, a number for each direction, where the file holds one geometry.
nlohmann::ordered_json FileEntry(const GeometryFile& file);

// "surface of degree 2,1, 9 x 2 control points", of an entry with these.
std::string ShapeWords(const nlohmann::ordered_json& entry);

// The same as a line for people: "part.json: surface of degree 2,1, 9 x 2 control points".
std::string FileLine(const nlohmann::ordered_json& entry);

}  // namespace batten::internal
