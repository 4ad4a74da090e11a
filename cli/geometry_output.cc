// SPDX-License-Identifier: MIT
#include "batten/cli/geometry_output.h"

#include "batten/cli/fit_output.h"
#include "batten/cli/parse_values.h"
#include "batten/cli/terminal.h"

namespace batten {

void AddStepSchemaFlag(CLI::App& command, std::string& schema) {
  command
      .add_option_function<std::string>(
          "--step-schema",
          [&schema](const std::string& text) {
            CheckChoice("--step-schema", text, {"ap214", "ap242"});
            schema = text;
          },
          "Application protocol of STEP: ap214, or ap242")
      ->default_str(schema)
      ->type_name("SCHEMA");
}

void AddGeometryOutput(CLI::App& command, GeometryOutput& output) {
  command
      .add_option_function<std::string>(
          "--unit",
          [&output](const std::string& text) {
            CheckUnit(text);
            output.unit = text;
          },
          "Unit of what is written, declared in STEP and IGES: coordinates of a file in another\n"
          "are turned into it [the file's own, mm where it says none]")
      ->type_name("UNIT");
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

GeometryWriteOptions WriteOptions(const std::string& format,
                                  const GeometryOutput& output,
                                  const GeometryContents& read) {
  GeometryWriteOptions options;
  options.format = format;
  if (!read.unit.empty()) options.unit = read.unit;
  options.step_schema = output.step_schema;
  return options;
}

}  // namespace batten
