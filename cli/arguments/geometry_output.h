// SPDX-License-Identifier: MIT
// What commands that turn geometry into geometry share: the unit, the STEP schema, what is said of
// a file that is not quite as it should be.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "batten/io/geometry_types.h"
#include "cli/terminal/cli11_forward.h"

namespace batten::internal {

// --step-schema ap214|ap242
void AddStepSchemaFlag(CLI::App& command, std::string& schema);

// How files of geometry are read.
struct GeometryInput {
  bool strict = false;        // GeometryReadOptions
  bool accept_doubt = false;  // end with 0 though a part could not be read
};
// --strict and --accept-doubt
void AddGeometryInput(CLI::App& command, GeometryInput& input);

// Warns of each face and curve that could not be read, and has the program end doubtful.
void TellUnread(const std::string& path,
                const GeometryContents& contents,
                const GeometryInput& input,
                bool quiet);

struct GeometryOutput {
  std::string unit;             // asked for; empty: that of what is read, mm where it says none
  std::string undeclared = {};  // of a file that says none: GeometryReadOptions
  std::string step_schema = GeometryWriteOptions().step_schema;
  std::optional<double> sew = {};  // GeometryWriteOptions
  GeometryInput input = {};
};
// --unit, --step-schema and those of AddGeometryInput. Refuses units and schemas there are not when
// they are parsed.
void AddGeometryOutput(CLI::App& command, GeometryOutput& output);

// --sew
void AddSewFlag(CLI::App& command, GeometryOutput& output);

// Throws std::invalid_argument where a coordinate is beyond 1e100.
void RequireSensible(const std::vector<Geometry>& geometry);

// Whether what is written holds solids and shells, so that those that are read need not be lost.
bool KeepsBodies(const std::string& path, const std::string& format, const GeometryOutput& output);

// What a result has of the file it is made from: curves and surfaces; which of them are bodies; all
// that is in it, what could not be read too.
enum class Kept { kGeometry, kBodies, kShapes };

// Reads the file in the unit asked for, and warns of what it leaves open, and of what is lost,
// unless `quiet`.
GeometryContents ReadInUnit(const std::string& path,
                            const std::string& format,
                            const GeometryOutput& output,
                            bool quiet,
                            Kept kept = Kept::kGeometry);

// What sewing came to, as "sewing" of a file's entry and as a sentence: a note, or a warning where
// edges are free that were not in what was read.
nlohmann::ordered_json SewingJson(const SewingReport& report);
void TellSewing(const std::string& path,
                const SewingReport& report,
                const std::vector<GeometryBody>& read);

// The surfaces among what was read, with their names and bodies. Warns of curves that are left out,
// and `why`; throws ReadError where there is no surface.
struct NamedSurfaces {
  std::vector<NurbsSurface> surfaces;
  std::vector<std::string> names;
  std::vector<GeometryBody> bodies = {};  // `surfaces` are places among these; no free edges
};
NamedSurfaces SurfacesAlone(const std::string& path,
                            const GeometryContents& contents,
                            const std::string& why,
                            bool quiet);

// How to write what was read.
GeometryWriteOptions WriteOptions(const std::string& format,
                                  const GeometryOutput& output,
                                  const GeometryContents& read);

}  // namespace batten::internal
