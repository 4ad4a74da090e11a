// SPDX-License-Identifier: MIT
// The shapes of a file as they were read, and as they are written again. Not installed; includes
// OpenCASCADE.
#pragma once

#include <optional>
#include <vector>

#include "batten/io/geometry_types.h"
#include "io/opencascade/export_parts.h"

namespace batten::internal {

// What CadShapes holds: solids, shells outside solids, faces and edges outside both, each a part,
// in the order of the file.
struct HeldShapes {
  std::vector<ExportPart> parts;
  std::vector<size_t> bodies;  // which of them are the bodies of the file's contents
};

// Of each body.
std::vector<BodyMeasures> MeasureShapes(const CadShapes& shapes);

// What a file is written as: the shapes that it holds, in the coordinates asked for, with a report
// of the solids and shells among them; where it holds none or `sew` is set, ExportParts. Throws as
// that does.
std::vector<ExportPart> PartsToWrite(const GeometryFile& file,
                                     const std::optional<double>& sew,
                                     std::optional<SewingReport>& report);

}  // namespace batten::internal
