// SPDX-License-Identifier: MIT
// OpenCASCADE's work behind pointers: what needs it lives in a module that is loaded at the first
// call, for OpenCASCADE takes longer to load than most commands take to run.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "batten/fitting/trimmed_solid.h"
#include "batten/geometry/solid_model.h"
#include "batten/io/geometry_types.h"
#include "batten/io/length_unit.h"

namespace batten::internal {

// What the module `libbatten_opencascade.so` does (io/opencascade). The module hands out the
// address of one such table: `batten_opencascade_functions`.
struct OpenCascadeFunctions {
  // step_import.h
  GeometryContents (*import_step)(std::string text, const std::string& name);
  // step_export.h
  std::string (*export_step)(const GeometryFile& file,
                             const char* unit,
                             const char* schema,
                             const std::optional<double>& sew,
                             std::optional<SewingReport>& report);
  // solid_export.h
  std::string (*export_solid)(const SolidModel& solid,
                              const std::string& path,
                              const char* unit,
                              const char* schema);
  // trimmed_solid_export.h
  std::string (*export_trimmed_solid)(const TrimmedSolid& solid,
                                      const std::string& path,
                                      const char* unit,
                                      const char* schema,
                                      SolidCensus& census);
  // iges_export.h
  std::string (*export_iges)(const GeometryFile& file, const LengthUnit& unit);
  // brep_import.h
  GeometryContents (*import_brep)(std::string text, const std::string& name);
  // cad_shapes.h
  std::vector<BodyMeasures> (*measure_bodies)(const CadShapes& shapes);
  // iges_import.h
  GeometryContents (*import_iges)(const std::string& text, const std::string& name);
  // brep_export.h
  std::string (*export_brep)(const GeometryFile& file,
                             const std::optional<double>& sew,
                             std::optional<SewingReport>& report);
};

// The functions of the module, which is loaded when it has not been yet, from any thread, and stays
// until the process ends. Throws std::runtime_error as LoadOpenCascade does.
const OpenCascadeFunctions& OpenCascade();

}  // namespace batten::internal
