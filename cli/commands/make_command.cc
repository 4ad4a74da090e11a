// SPDX-License-Identifier: MIT
// batten make: exact curves and surfaces from numbers.
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
#include "cli/arguments/make_shapes.h"
#include "cli/commands/commands.h"
#include "cli/terminal/cli11.h"
#include "cli/terminal/common_flags.h"
#include "cli/terminal/exit_codes.h"
#include "cli/terminal/streams.h"

namespace batten::internal {
namespace {

struct MakeCommandArguments {
  MakeArguments shape;
  std::string out, out_format, unit = "mm", step_schema = GeometryWriteOptions().step_schema;
  CommonFlags flags;
};

// Squares of lengths must stay numbers for whoever reads the file.
void RequireSensible(const std::vector<Geometry>& geometry) {
  constexpr double kLargest = 1e100;
  for (const Geometry& one : geometry) {
    const double largest =
        std::visit([](const auto& g) { return g.control_points().cwiseAbs().maxCoeff(); }, one);
    if (largest > kLargest) {
      throw std::invalid_argument("coordinates beyond 1e100 are of no use to any CAD system");
    }
  }
}

int RunMake(const MakeKind& kind, const MakeCommandArguments& a) {
  CheckUnit(a.unit);
  CheckDistinct({a.out}, a.flags.json);
  CheckGeometryFormat(a.out, a.out_format);
  CheckWritable(a.out);
  GeometryFile file{a.out, {}};
  nlohmann::ordered_json said;
  try {
    file.geometry = kind.make(a.shape);
    RequireSensible(file.geometry);
    if (kind.tell) said = kind.tell(a.shape, file.geometry);
  } catch (const std::invalid_argument& error) {
    throw UsageError(std::string("make ") + kind.name + ": " + error.what());
  }
  WriteGeometryFiles({file}, {a.out_format, a.unit, a.step_schema});
  auto entry = FileEntry(file);
  const std::string line = FileLine(entry);
  if (!said.is_null()) entry.update(said);
  if (a.flags.json) {
    PrintFiles(entry);
  } else if (!a.flags.quiet && a.out != "-") {
    PrintResult(line);
    if (!said.is_null()) PrintAligned(said);
  }
  return said.is_null() || said.value("tolerance_reached", true) ? kDone : kToleranceMissed;
}

void AddKind(CLI::App& make, const MakeKind& kind, Action& action) {
  auto a = std::make_shared<MakeCommandArguments>();
  CLI::App& command = *make.add_subcommand(kind.name, kind.what);
  kind.add_flags(command, a->shape);
  command.add_option("-o,--output", a->out, "Where to write: .step .iges .brep .json")
      ->required()
      ->type_name("OUT");
  AddOutputFormatFlag(command, a->out_format);
  AddUnitFlag(command, a->unit, "Unit of the numbers, declared in STEP and IGES");
  AddStepSchemaFlag(command, a->step_schema);
  AddCommonFlags(command, a->flags);
  command.footer(std::string("Example:\n  batten make ") + kind.examples);
  command.callback([a, &kind, &action] { action = [a, &kind] { return RunMake(kind, *a); }; });
}

}  // namespace

void AddMakeCommand(CLI::App& app, Action& action) {
  CLI::App& make = *app.add_subcommand("make", "Make exact curves and surfaces from numbers");
  make.require_subcommand(1);
  std::string examples;
  for (const MakeKind& kind : MakeKinds()) {
    AddKind(make, kind, action);
    examples += std::string("\n  batten make ") + kind.examples;
  }
  make.footer(
      "Everything is exact to rounding, as rational quadratics on [0, 1]; u goes round the axis, v "
      "along\n"
      "the profile, normals look outward. In STEP planes, cylinders, cones, spheres, tori, lines "
      "and\n"
      "circles are the analytic shapes.\n"
      "Examples:" +
      examples);
}

}  // namespace batten::internal
