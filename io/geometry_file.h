// SPDX-License-Identifier: MIT
// Curves and surfaces from and to files.
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
  std::string format;  // "json", "step" or "iges"; empty: by the path's extension
};

// Every curve and surface of a file, in its order and its own unit; at least one. The path "-" is
// standard input and needs a format. Throws ReadError for a file that can't be used, UsageError for
// an unknown format or extension.
std::vector<Geometry> ReadGeometry(const std::string& path,
                                   const GeometryReadOptions& options = {});

struct GeometryWriteOptions {
  std::string format;       // "json", "step" or "iges"; empty: by the path's extension
  std::string unit = "mm";  // of the coordinates: declared in STEP and IGES, never scaled
};

// Refuses a path no geometry can be written to for its format. Throws UsageError.
void CheckGeometryFormat(const std::string& path, const std::string& format = "");

// Writes the file whole or not at all. The path "-" is standard output and needs a format. Throws
// WriteError, UsageError, or std::invalid_argument without geometry.
void WriteGeometry(const std::vector<Geometry>& geometry,
                   const std::string& path,
                   const GeometryWriteOptions& options = {});

struct GeometryFile {
  std::string path;
  std::vector<Geometry> geometry;
};

// Writes every file, or none: nothing appears before all are written. Throws as WriteGeometry.
void WriteGeometryFiles(const std::vector<GeometryFile>& files,
                        const GeometryWriteOptions& options = {});

}  // namespace batten
