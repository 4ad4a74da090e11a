// SPDX-License-Identifier: MIT
#include "cli/arguments/geometry_output.h"

#include <fmt/format.h>

#include <variant>

#include "batten/io/geometry_file.h"
#include "batten/io/read_error.h"
#include "cli/arguments/geometry_flags.h"
#include "cli/terminal/cli11.h"
#include "cli/terminal/offered_words.h"
#include "cli/terminal/terminal.h"

namespace batten::internal {

void AddStepSchemaFlag(CLI::App& command, std::string& schema) {
  Allow(
      *command.add_option("--step-schema", schema, "Application protocol of STEP: ap214, or ap242")
           ->capture_default_str()
           ->type_name("SCHEMA"),
      {"ap214", "ap242"});
}

void AddGeometryOutput(CLI::App& command, GeometryOutput& output) {
  CLI::Option& unit = *command
                           .add_option_function<std::string>(
                               "--unit",
                               [&output](const std::string& text) {
                                 CheckUnit(text);
                                 output.unit = text;
                               },
                               "Unit of what is written, declared in STEP and IGES: coordinates of "
                               "a file in another\n"
                               "are turned into it [the file's own, mm where it says none]")
                           ->type_name("UNIT");
  Suggest(unit, Units());
  AddStepSchemaFlag(command, output.step_schema);
}

GeometryContents ReadInUnit(const std::string& path,
                            const std::string& format,
                            const GeometryOutput& output,
                            bool quiet) {
  GeometryContents contents = ReadGeometryContents(path, {format, output.unit});
  if (!quiet) {
    for (const std::string& remark : contents.remarks) PrintWarning(path + ": " + remark);
  }
  return contents;
}

NamedSurfaces SurfacesAlone(const std::string& path,
                            const GeometryContents& contents,
                            const std::string& why,
                            bool quiet) {
  NamedSurfaces found;
  for (size_t k = 0; k < contents.geometry.size(); ++k) {
    const auto* surface = std::get_if<NurbsSurface>(&contents.geometry[k]);
    if (surface == nullptr) continue;
    found.surfaces.push_back(*surface);
    found.names.push_back(contents.names[k]);
  }
  if (found.surfaces.empty()) throw ReadError(path, "holds no surface, only curves");
  const size_t curves = contents.geometry.size() - found.surfaces.size();
  if (curves > 0 && !quiet) {
    PrintWarning(fmt::format("{}: {} left out: {}",
                             path,
                             curves == 1 ? "a curve is" : fmt::format("{} curves are", curves),
                             why));
  }
  return found;
}

GeometryWriteOptions WriteOptions(const std::string& format,
                                  const GeometryOutput& output,
                                  const GeometryContents& read) {
  GeometryWriteOptions options;
  options.format = format;
  if (!read.unit.empty()) options.unit = read.unit;
  options.step_schema = output.step_schema;
  return options;
}

}  // namespace batten::internal
