// SPDX-License-Identifier: MIT
// What a file's geometry is written as. Not installed; includes OpenCASCADE.
#pragma once

#include <TopoDS_Shape.hxx>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "batten/io/geometry_types.h"

namespace batten::internal {

// A shape that stands by itself, and what it and its faces are called; empty: no name.
struct ExportPart {
  TopoDS_Shape shape;
  std::string name;
  std::vector<std::pair<TopoDS_Shape, std::string>> faces = {};
};

// The geometry in its order, each a part (valid_shape.h), but surfaces that are sewn where the
// first of them stands. `sew` is that of GeometryWriteOptions; the report stays empty where nothing
// was to be sewn. Throws Standard_Failure where no valid shape can be built.
std::vector<ExportPart> ExportParts(const GeometryFile& file,
                                    const std::optional<double>& sew,
                                    std::optional<SewingReport>& report);

}  // namespace batten::internal
