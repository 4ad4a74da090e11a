// SPDX-License-Identifier: MIT
#include "batten/cli/geometry_flags.h"

#include "batten/cli/fit_output.h"
#include "batten/cli/offered_words.h"

namespace batten {
namespace {

void AddFormat(CLI::App& command, const char* flag, std::string& format, const char* help) {
  CLI::Option& option = *command.add_option(flag, format, help)->type_name("FORMAT");
  Suggest(option, {"json", "step", "iges"});
}

}  // namespace

CLI::Option& AddUnitFlag(CLI::App& command, std::string& unit, const char* help) {
  CLI::Option& option =
      *command.add_option("--unit", unit, help)->capture_default_str()->type_name("UNIT");
  Suggest(option, Units());
  return option;
}

void AddGeometryFormatFlag(CLI::App& command, std::string& format, const char* help) {
  AddFormat(command, "--format", format, help);
}

void AddOutputFormatFlag(CLI::App& command, std::string& format, const char* help) {
  AddFormat(command, "--output-format", format, help);
}

}  // namespace batten
