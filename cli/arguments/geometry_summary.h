// SPDX-License-Identifier: MIT
// What `analyze` and `info` say of a file, as JSON and as text.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "batten/io/geometry_types.h"

namespace batten::internal {

// {"kind", "degree", "control_points", "knots", "domain", "periodic", "continuity", "rational",
// "closed", "seam"[, "trims"], "bounding_box", "length" | "area", "curvature", "shape"[,
// "shape_parameters"][, "pieces"][, "cubics"]}.
//  continuity: per direction, the least k of C^k over the interior knots as measured there; the
//    degree where there is none. seam: the same from the end of a closed direction to its start,
//    null where it is not closed. trims: of a surface, how many loops bound the part that counts,
//    which box, area and curvature are of; 0: the whole.
//  curvature: the extremes of a curve's curvature, of a surface's principal curvatures; null for
//    none, and in place of what grows without bound.
//  pieces: of a curve with knots of full multiplicity, and of every one of degree 2, what each
//  piece
//    is (PieceShapes): {"domain", "shape"[, "shape_parameters"][, "shape_factor"]}.
//  cubics: of a curve of degree 3 (FeaturesOfCubic): {"domain", "kind"[, "inflections"][, "cusp"][,
//    "loop"][, "torsion": {"min", "max"}]}.
//  shape: NameOf(ClassifyShape(…, {tolerance})); its parameters in the data's units and radians.
nlohmann::ordered_json SummaryOf(const Geometry& geometry, double tolerance);

// The summary of the only one with "name", "unit", "remarks" and "bodies" where there are any; or
// {"unit", "remarks", "bodies", "surfaces", "curves", "results": […]} with "index" and "name".
// bodies: of every solid and shell {["name", ]"kind", "surfaces" by index, "shared_edges",
// "watertight", "free_edges": [{"surface", "from", "to"}]}.
nlohmann::ordered_json SummaryOf(const GeometryContents& contents, double tolerance);

// An object a line for a key, then each of its "results"; objects inside are indented.
void PrintAligned(const nlohmann::ordered_json& summary);

// One line of JSON, or many with an indent. Names in files need not be UTF-8: what is not becomes
// the replacement character.
std::string JsonText(const nlohmann::ordered_json& json, int indent = -1);

}  // namespace batten::internal
