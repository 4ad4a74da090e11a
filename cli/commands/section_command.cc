// SPDX-License-Identifier: MIT
// batten section: the curves in which a plane meets surfaces.
#include <fmt/format.h>

#include <iterator>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "batten/geometry/plane_section.h"
#include "batten/io/geometry_file.h"
#include "batten/io/read_error.h"
#include "cli/arguments/file_entry.h"
#include "cli/arguments/fit_output.h"
#include "cli/arguments/geometry_flags.h"
#include "cli/arguments/geometry_output.h"
#include "cli/commands/commands.h"
#include "cli/terminal/cli11.h"
#include "cli/terminal/common_flags.h"
#include "cli/terminal/exit_codes.h"
#include "cli/terminal/parse_values.h"
#include "cli/terminal/streams.h"
#include "cli/terminal/terminal.h"

namespace batten::internal {
namespace {

using Json = nlohmann::ordered_json;

struct SectionArguments {
  std::string geometry, out, format, out_format, plane_text;
  Plane plane;
  std::optional<double> tolerance;
  GeometryOutput output;
  CommonFlags flags;
};

// What a drawing needs; nearer costs control points.
constexpr double kToleranceOfSize = 1e-4;

Plane ParsePlane(const std::string& text) {
  const std::vector<double> x = ParseNumbers("--plane", text);
  if (x.size() != 4) {
    throw UsageError(fmt::format("--plane: '{}' holds {} numbers; 4 are needed", text, x.size()));
  }
  if (x[0] == 0 && x[1] == 0 && x[2] == 0) {
    throw UsageError("--plane: '" + text + "' has no normal: a, b and c are all zero");
  }
  return {{x[0], x[1], x[2]}, -x[3]};
}

// The section inside the trims, in space, joined over seams and poles.
std::vector<NurbsCurve<3>> CurvesOf(const NurbsSurface& surface, const SectionArguments& a) {
  const auto& points = surface.control_points();
  const double size = (points.rowwise().maxCoeff() - points.rowwise().minCoeff()).norm();
  const SectionOptions options{.tolerance = a.tolerance.value_or(kToleranceOfSize * size)};
  const PlaneSection section = SectionInside(surface, Section(surface, a.plane, options));
  std::vector<NurbsCurve<3>> curves;
  for (const auto* some : {&section.curves, &section.edges}) {
    for (const SectionCurve& curve : *some) curves.push_back(curve.points);
  }
  constexpr double kOneEnd = 1e-8;
  return curves.empty() ? curves : JoinedInSpace(std::move(curves), kOneEnd * size);
}

int RunSection(const SectionArguments& a) {
  CheckDistinct({a.out}, a.flags.json);
  const std::string& out_format = a.out_format.empty() && a.out == "-" ? a.format : a.out_format;
  CheckGeometryFormat(a.out, out_format);
  CheckWritable(a.out);
  BeginReading({a.geometry}, a.flags.quiet);
  std::vector<Geometry> curves;
  std::vector<std::string> names;
  const GeometryContents contents = ReadInUnit(a.geometry, a.format, a.output, a.flags.quiet);
  const NamedSurfaces named =
      SurfacesAlone(a.geometry, contents, "only surfaces have sections", a.flags.quiet);
  for (size_t i = 0; i < named.surfaces.size(); ++i) {
    std::vector<NurbsCurve<3>> some = CurvesOf(named.surfaces[i], a);
    curves.insert(
        curves.end(), std::make_move_iterator(some.begin()), std::make_move_iterator(some.end()));
    names.resize(curves.size(), named.names[i]);
  }
  if (curves.empty()) {
    throw ReadError(a.geometry, "the plane " + a.plane_text + " does not cut it");
  }
  const GeometryFile file{a.out, std::move(curves), std::move(names)};
  WriteGeometryFiles({file}, WriteOptions(out_format, a.output, contents));
  ClearProgress();
  if (a.flags.json) {
    PrintFiles(FileEntry(file));
  } else if (!a.flags.quiet && a.out != "-") {
    PrintResult(FileLine(FileEntry(file)));
  }
  return kDone;
}

}  // namespace

void AddSectionCommand(CLI::App& app, Action& action) {
  auto a = std::make_shared<SectionArguments>();
  CLI::App& command =
      *app.add_subcommand("section", "Cut surfaces with a plane: the curves where they meet it");
  command.add_option("GEOMETRY", a->geometry, "Surfaces: .json .step .iges .brep")->required();
  command
      .add_option_function<std::string>(
          "--plane",
          [a](const std::string& text) {
            a->plane_text = text;
            a->plane = ParsePlane(text);
          },
          "The plane a x + b y + c z + d = 0")
      ->required()
      ->type_name("a,b,c,d");
  command.add_option("-o,--output", a->out, "Where to write the curves: .step .iges .brep .json")
      ->required()
      ->type_name("OUT");
  command
      .add_option_function<std::string>(
          "--tolerance",
          [a](const std::string& text) {
            a->tolerance = ParseNumber("--tolerance", text, Sign::kPositive);
          },
          "How far the curves may be from the surface [1e-4 of its size]")
      ->type_name("T");
  AddGeometryFormatFlag(
      command,
      a->format,
      "Format of GEOMETRY where its name does not tell, or of '-': json step iges brep");
  AddOutputFormatFlag(command, a->out_format);
  AddGeometryOutput(command, a->output);
  AddCommonFlags(command, a->flags);
  command.footer(
      "Every curve is written once, in space, closed where it is. On trimmed surfaces it ends at\n"
      "the loops. A plane that only touches, or misses, the surface: exit code 1, nothing "
      "written.\n"
      "Examples:\n"
      "  batten section part.step --plane 0,0,1,-25 -o height25.json\n"
      "  batten section hull.json --plane 1,0,0,-4.5 -o frame.step --tolerance 1e-6");
  command.callback([a, &action] { action = [a] { return RunSection(*a); }; });
}

}  // namespace batten::internal
