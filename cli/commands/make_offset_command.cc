// SPDX-License-Identifier: MIT
// batten make offset: curves and surfaces at a distance.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "batten/geometry/offset_curve.h"
#include "batten/geometry/offset_surface.h"
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

struct OffsetArguments {
  std::string geometry, out, format, out_format;
  double distance = 0;
  std::optional<double> tolerance;
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  bool trim_loops = false;
  GeometryOutput output;
  CommonFlags flags;
};

Eigen::Vector3d ParseNormal(const std::string& text) {
  const std::vector<double> x = ParseNumbers("--normal", text);
  if (x.size() != 3 || (x[0] == 0 && x[1] == 0 && x[2] == 0)) {
    throw UsageError("--normal: '" + text + "' is not three numbers x,y,z of a direction");
  }
  return {x[0], x[1], x[2]};
}

// One that leaves digits to the geometry it is added to.
double ParseDistance(const std::string& text) {
  constexpr double kFarthest = 1e100;
  const double distance = ParseNumber("--distance", text);
  if (!(std::abs(distance) <= kFarthest)) {
    throw UsageError("--distance: " + text +
                     " is beyond 1e100: such coordinates are of no use to any CAD system");
  }
  return distance;
}

// What became of everything in the file.
struct Offsets {
  std::vector<Geometry> geometry;
  Json entries = Json::array();
  std::vector<std::string> notes;
  bool reached = true;
};

template <typename Point>
Json Places(const Point& point) {
  return Json(std::vector<double>(point.data(), point.data() + point.size()));
}

template <int Dim>
void AddCurve(const OffsetArguments& a, const NurbsCurve<Dim>& curve, Offsets& offsets) {
  const OffsetOptions options{.tolerance = a.tolerance};
  const CurveOffset<Dim> offset = [&] {
    if constexpr (Dim == 2) {
      return OffsetCurve(curve, a.distance, options);
    } else {
      return OffsetCurve(curve, a.normal, a.distance, options);
    }
  }();
  Json meetings = Json::array();
  for (const auto& one : offset.self_meetings) meetings.push_back(Places(one.point));
  offsets.entries.push_back(
      {{"exact", offset.exact}, {"deviation", offset.deviation}, {"self_meetings", meetings}});
  if (!a.trim_loops) {
    offsets.geometry.emplace_back(offset.curve);
    if (!meetings.empty()) {
      offsets.notes.push_back(
          fmt::format("the offset meets itself at {} places; --trim-loops cuts its loops away",
                      meetings.size()));
    }
    return;
  }
  const auto kept = WithoutLoops(offset, curve, a.distance, options);
  if (kept.empty()) {
    throw ReadError(a.geometry, "nothing of the curve's offset is as far from it as the distance");
  }
  offsets.geometry.insert(offsets.geometry.end(), kept.begin(), kept.end());
}

void AddSurface(const OffsetArguments& a, const NurbsSurface& surface, Offsets& offsets) {
  const SurfaceOffset offset = OffsetSurface(surface, a.distance, {.tolerance = a.tolerance});
  Json meetings = Json::array();
  for (const auto& one : offset.self_meetings) meetings.push_back(Places(one.point));
  offsets.entries.push_back(
      {{"exact", offset.exact}, {"deviation", offset.deviation}, {"self_meetings", meetings}});
  offsets.geometry.emplace_back(offset.surface);
  offsets.reached = offsets.reached && offset.tolerance_reached;
  if (!meetings.empty()) {
    const auto& at = offset.self_meetings.front().point;
    offsets.notes.push_back(fmt::format(
        "the offset crosses itself, at {:.6g}, {:.6g}, {:.6g} for one", at[0], at[1], at[2]));
  }
}

Offsets OffsetsOf(const OffsetArguments& a, const std::vector<Geometry>& geometry) {
  Offsets offsets;
  for (const Geometry& one : geometry) {
    try {
      std::visit(
          [&](const auto& shape) {
            if constexpr (std::is_same_v<std::decay_t<decltype(shape)>, NurbsSurface>) {
              AddSurface(a, shape, offsets);
            } else {
              AddCurve(a, shape, offsets);
            }
          },
          one);
    } catch (const std::invalid_argument& error) {
      throw UsageError(std::string("make offset: ") + error.what());
    }
  }
  try {
    RequireSensible(offsets.geometry);
  } catch (const std::invalid_argument& error) {
    throw UsageError(std::string("make offset: ") + error.what());
  }
  return offsets;
}

int RunOffset(const OffsetArguments& a) {
  CheckDistinct({a.out}, a.flags.json);
  const std::string& out_format = a.out_format.empty() && a.out == "-" ? a.format : a.out_format;
  CheckGeometryFormat(a.out, out_format);
  CheckWritable(a.out);
  BeginReading({a.geometry}, a.flags.quiet);
  const GeometryContents contents = ReadInUnit(a.geometry, a.format, a.output, a.flags.quiet);
  Offsets offsets = OffsetsOf(a, contents.geometry);
  const GeometryFile file{a.out, std::move(offsets.geometry)};
  WriteGeometryFiles({file}, WriteOptions(out_format, a.output, contents));
  ClearProgress();
  Json entry = FileEntry(file);
  entry["offsets"] = offsets.entries;
  entry["tolerance_reached"] = offsets.reached;
  if (!a.flags.quiet) {
    for (const std::string& note : offsets.notes) WriteToErrors("batten: " + note + "\n");
  }
  if (a.flags.json) {
    PrintFiles(entry);
  } else if (!a.flags.quiet && a.out != "-") {
    double most = 0;
    bool exact = true;
    for (const Json& one : offsets.entries) {
      most = std::max(most, one["deviation"].get<double>());
      exact = exact && one["exact"].get<bool>();
    }
    PrintVerdict(FileLine(entry) + (exact ? ", exact" : fmt::format(", off by {:.2g}", most)),
                 offsets.reached);
  }
  return offsets.reached ? kDone : kToleranceMissed;
}

}  // namespace

void AddMakeOffsetCommand(CLI::App& make, Action& action) {
  auto a = std::make_shared<OffsetArguments>();
  CLI::App& command =
      *make.add_subcommand("offset", "Curves and surfaces at a distance from others");
  command.add_option("GEOMETRY", a->geometry, "Curves or surfaces: .json .step .iges .brep")
      ->required();
  command
      .add_option_function<std::string>(
          "--distance",
          [a](const std::string& text) { a->distance = ParseDistance(text); },
          "How far: along the surface's normal, to the left of a curve; negative: to the other "
          "side")
      ->required()
      ->type_name("D");
  command
      .add_option_function<std::string>(
          "--tolerance",
          [a](const std::string& text) {
            a->tolerance = ParseNumber("--tolerance", text, Sign::kPositive);
          },
          "How far the result may be from the exact offset [1e-6 of the size]")
      ->type_name("T");
  command
      .add_option_function<std::string>(
          "--normal",
          [a](const std::string& text) { a->normal = ParseNormal(text); },
          "Of curves in space: from the tip of which left is seen")
      ->type_name("X,Y,Z")
      ->default_str("0,0,1");
  command.add_flag("--trim-loops", a->trim_loops, "Curves: cut away what comes nearer than D");
  command.add_option("-o,--output", a->out, "Where to write: .step .iges .brep .json")
      ->required()
      ->type_name("OUT");
  AddGeometryFormatFlag(
      command,
      a->format,
      "Format of GEOMETRY where its name does not tell, or of '-': json step iges brep");
  AddOutputFormatFlag(command, a->out_format);
  AddGeometryOutput(command, a->output);
  AddCommonFlags(command, a->flags);
  command.footer(
      "Lines, circles, planes, cylinders, cones, spheres and tori stay what they are, exactly; "
      "all\n"
      "else is a cubic measured against the exact offset. Trims stay. A distance beyond the "
      "radius\n"
      "of curvature is refused with the smallest radius and its place; corners of curves get "
      "arcs.\n"
      "Examples:\n"
      "  batten make offset panel.step -o inner.step --distance -1.5\n"
      "  batten make offset outline.json -o tool-path.json --distance 3 --trim-loops");
  command.callback([a, &action] { action = [a] { return RunOffset(*a); }; });
}

}  // namespace batten::internal
