// SPDX-License-Identifier: MIT
// batten make: exact curves and surfaces from numbers, surfaces from curves.
#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "batten/io/geometry_file.h"
#include "batten/io/read_error.h"
#include "cli/arguments/file_entry.h"
#include "cli/arguments/fit_output.h"
#include "cli/arguments/geometry_flags.h"
#include "cli/arguments/geometry_output.h"
#include "cli/arguments/geometry_summary.h"
#include "cli/arguments/make_constructions.h"
#include "cli/arguments/make_shapes.h"
#include "cli/commands/commands.h"
#include "cli/terminal/cli11.h"
#include "cli/terminal/common_flags.h"
#include "cli/terminal/exit_codes.h"
#include "cli/terminal/streams.h"
#include "cli/terminal/terminal.h"

namespace batten::internal {
namespace {

// Of shapes made from numbers, or of constructions from curves.
template <typename Arguments>
struct MakeCommandArguments {
  Arguments shape;
  std::string out, out_format, unit, step_schema = GeometryWriteOptions().step_schema;
  CommonFlags flags;
};

template <typename Kind, typename Arguments>
int RunMake(const Kind& kind, const MakeCommandArguments<Arguments>& a) {
  if (!a.unit.empty()) CheckUnit(a.unit);
  a.shape.unit->Ask(a.unit);
  CheckDistinct({a.out}, a.flags.json);
  CheckGeometryFormat(a.out, a.out_format);
  CheckWritable(a.out);
  GeometryFile file{a.out, {}};
  nlohmann::ordered_json said;
  std::vector<std::string> notes;
  try {
    Construction made{kind.make(a.shape)};
    file.geometry = std::move(made.shapes);
    notes = std::move(made.notes);
    RequireSensible(file.geometry);
    if constexpr (requires { kind.tell; }) {
      if (kind.tell) said = kind.tell(a.shape, file.geometry);
    }
  } catch (const std::invalid_argument& error) {
    throw UsageError(std::string("make ") + kind.name + ": " + error.what());
  }
  WriteGeometryFiles({file}, {a.out_format, a.shape.unit->name(), a.step_schema});
  auto entry = FileEntry(file);
  const std::string line = FileLine(entry);
  if (!said.is_null()) entry.update(said);
  if (!notes.empty()) entry["notes"] = notes;
  if (!a.flags.quiet) {
    for (const std::string& note : notes) PrintNote(note);
  }
  if (a.flags.json) {
    PrintFiles(entry);
  } else if (!a.flags.quiet && a.out != "-") {
    PrintResult(line);
    if (!said.is_null()) PrintAligned(said);
  }
  return said.is_null() || said.value("tolerance_reached", true) ? kDone : kToleranceMissed;
}

template <typename Arguments, typename Kind>
void AddKind(CLI::App& make, const Kind& kind, Action& action) {
  auto a = std::make_shared<MakeCommandArguments<Arguments>>();
  CLI::App& command = *make.add_subcommand(kind.name, kind.what);
  kind.add_flags(command, a->shape);
  command.add_option("-o,--output", a->out, "Where to write: .step .iges .brep .json")
      ->required()
      ->type_name("OUT");
  AddOutputFormatFlag(command, a->out_format);
  const bool reads_files = command.get_option_no_throw("--format") != nullptr;
  if (!reads_files) a->unit = a->shape.unit->name();
  AddUnitFlag(
      command,
      a->unit,
      reads_files
          ? "Unit of the numbers and of what is written, declared in STEP and IGES: "
            "coordinates of files in another are turned into it [the first file's, mm where it "
            "says none]"
          : "Unit of the numbers, declared in STEP and IGES");
  AddStepSchemaFlag(command, a->step_schema);
  AddCommonFlags(command, a->flags);
  command.footer(std::string("Example:\n  batten make ") + kind.examples);
  command.callback([a, &kind, &action] { action = [a, &kind] { return RunMake(kind, *a); }; });
}

}  // namespace

void AddMakeCommand(CLI::App& app, Action& action) {
  CLI::App& make = *app.add_subcommand(
      "make", "Make exact curves and surfaces from numbers, and surfaces from curves");
  make.require_subcommand(1);
  std::string examples;
  for (const MakeKind& kind : MakeKinds()) {
    AddKind<MakeArguments>(make, kind, action);
    examples += std::string("\n  batten make ") + kind.examples;
  }
  for (const ConstructionKind& kind : ConstructionKinds()) {
    AddKind<ConstructionArguments>(make, kind, action);
    examples += std::string("\n  batten make ") + kind.examples;
  }
  AddMakeOffsetCommand(make, action);
  examples += "\n  batten make offset panel.step -o inner.step --distance -1.5";
  make.footer(
      "What is made from numbers is exact to rounding, as rational quadratics on [0, 1]; u goes "
      "round the\n"
      "axis, v along the profile, normals look outward. In STEP planes, cylinders, cones, spheres, "
      "tori,\n"
      "lines and circles are the analytic shapes. What is made from curves contains them, to "
      "rounding or\n"
      "to the tolerance that is told.\n"
      "Examples:" +
      examples);
}

}  // namespace batten::internal
