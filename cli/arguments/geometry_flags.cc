// SPDX-License-Identifier: MIT
#include "cli/arguments/geometry_flags.h"

#include "cli/terminal/cli11.h"
#include "cli/terminal/offered_words.h"
#include "cli/terminal/parse_values.h"

namespace batten::internal {
namespace {

void AddFormat(CLI::App& command, const char* flag, std::string& format, const char* help) {
  CLI::Option& option = *command.add_option(flag, format, help)->type_name("FORMAT");
  Suggest(option, {"json", "step", "iges", "brep"});
}

}  // namespace

const std::vector<std::string>& Units() {
  static const std::vector<std::string> units = {
      "mm", "cm", "m", "km", "um", "in", "inch", "ft", "mi", "mil", "uin"};
  return units;
}

void CheckUnit(const std::string& unit) { CheckChoice("--unit", unit, Units()); }

CLI::Option& AddUnitFlag(CLI::App& command, std::string& unit, const char* help) {
  CLI::Option& option = *command.add_option("--unit", unit, help)->type_name("UNIT");
  if (!unit.empty()) option.capture_default_str();
  Suggest(option, Units());
  return option;
}

void AddGeometryFormatFlag(CLI::App& command, std::string& format, const char* help) {
  AddFormat(command, "--format", format, help);
}

void AddOutputFormatFlag(CLI::App& command, std::string& format, const char* help) {
  AddFormat(command, "--output-format", format, help);
}

}  // namespace batten::internal
