// SPDX-License-Identifier: MIT
// batten intersect: where curves and surfaces meet.
#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "batten/geometry/arc_length.h"
#include "batten/geometry/intersect_curves.h"
#include "batten/geometry/intersect_surfaces.h"
#include "batten/io/geometry_file.h"
#include "batten/io/read_error.h"
#include "cli/arguments/file_entry.h"
#include "cli/arguments/fit_output.h"
#include "cli/arguments/geometry_flags.h"
#include "cli/arguments/geometry_output.h"
#include "cli/arguments/geometry_summary.h"
#include "cli/arguments/shared_unit.h"
#include "cli/commands/commands.h"
#include "cli/terminal/cli11.h"
#include "cli/terminal/common_flags.h"
#include "cli/terminal/exit_codes.h"
#include "cli/terminal/parse_values.h"
#include "cli/terminal/streams.h"
#include "cli/terminal/terminal.h"
#include "geometry/nurbs/placed_curve.h"

namespace batten::internal {
namespace {

using Json = nlohmann::ordered_json;

struct IntersectArguments {
  std::string first, second, out, format, out_format;
  std::optional<double> tolerance;
  GeometryOutput output;
  CommonFlags flags;
};

// What has been found of all pairs.
struct Meets {
  Json branches = Json::array(), points = Json::array(), overlaps = Json::array();
  std::vector<Geometry> curves;
  bool reached = true;  // the tolerance asked for, or the one chosen
};

Json Numbers(const Eigen::VectorXd& x) {
  return std::vector<double>(x.data(), x.data() + x.size());
}

template <typename Shape>
double SizeOf(const Shape& shape) {
  const auto& points = shape.control_points();
  return (points.rowwise().maxCoeff() - points.rowwise().minCoeff()).norm();
}

// The places at both ends, over all parts.
Json EndsOf(const std::vector<NurbsCurve<2>>& parts) {
  if (parts.empty()) return nullptr;
  return {Numbers(parts.front().At(parts.front().basis().lower())),
          Numbers(parts.back().At(parts.back().basis().upper()))};
}

// With a larger one everything would be one touch.
template <typename First, typename Second>
double ToleranceFor(const IntersectArguments& a, const First& first, const Second& second) {
  constexpr double kOfTheSize = 1e-6, kTolerancesInSize = 64;
  const double size = std::min(SizeOf(first), SizeOf(second));
  if (a.tolerance && size > 0 && *a.tolerance * kTolerancesInSize >= size) {
    throw UsageError(
        fmt::format("--tolerance: {} is not below a sixty-fourth of the smaller size, {:.6g}: "
                    "everything would be one touch; ask for less",
                    *a.tolerance,
                    size));
  }
  return a.tolerance.value_or(kOfTheSize * size);
}

void AddMeet(const IntersectArguments& a,
             const Json& pair,
             const NurbsSurface& first,
             const NurbsSurface& second,
             Meets& meets) {
  ToleranceFor(a, first, second);
  const SurfaceIntersection met = IntersectSurfaces(first, second, {.tolerance = a.tolerance});
  const auto with = [&](Json one) {
    if (!pair.is_null()) one["index"] = pair;
    return one;
  };
  for (const SurfaceBranch& branch : met.branches) {
    meets.branches.push_back(with({{"kind", NameOf(branch.kind)},
                                   {"closed", branch.closed},
                                   {"length", ArcLength(branch.curve)},
                                   {"deviation", branch.deviation},
                                   {"tolerance", met.tolerance},
                                   {"first", EndsOf(branch.on_first)},
                                   {"second", EndsOf(branch.on_second)}}));
    meets.curves.emplace_back(branch.curve);
    meets.reached &= branch.deviation <= a.tolerance.value_or(met.tolerance);
  }
  for (const SurfaceTouch& touch : met.touches) {
    meets.points.push_back(with({{"point", Numbers(touch.point)},
                                 {"tangential", true},
                                 {"on_branch", touch.on_branch},
                                 {"first", Numbers(touch.on_first)},
                                 {"second", Numbers(touch.on_second)}}));
  }
  for (const SurfaceOverlap& overlap : met.overlaps) {
    const auto box = [](const ParameterBox& b) { return Json{{b.u0, b.u1}, {b.v0, b.v1}}; };
    meets.overlaps.push_back(with({{"point", Numbers(overlap.point)},
                                   {"first", box(overlap.first)},
                                   {"second", box(overlap.second)}}));
  }
}

template <int Dim>
void AddMeet(const IntersectArguments& a,
             const Json& pair,
             const NurbsCurve<Dim>& curve,
             const NurbsSurface& surface,
             Meets& meets,
             bool swapped = false) {
  const NurbsCurve<3> spatial = InSpace(curve);
  const double tolerance = ToleranceFor(a, spatial, surface);
  const auto met = IntersectCurveSurface(spatial, surface, tolerance);
  const char *own = swapped ? "second" : "first", *other = swapped ? "first" : "second";
  for (const CurveSurfaceMeeting& one : met.points) {
    Json entry{
        {"point", Numbers(one.point)}, {"tangential", one.tangential}, {"gap", one.distance}};
    meets.reached &= !a.tolerance || one.distance <= tolerance;
    entry[own] = {one.on_curve};
    entry[other] = Numbers(one.on_surface);
    if (!pair.is_null()) entry["index"] = pair;
    meets.points.push_back(entry);
  }
  for (const CurveSurfaceOverlap& one : met.overlaps) {
    Json entry;
    entry[own] = {one.on_curve.lower, one.on_curve.upper};
    entry[other] = {Numbers(one.from), Numbers(one.to)};
    if (!pair.is_null()) entry["index"] = pair;
    meets.overlaps.push_back(entry);
  }
}

template <int Dim>
void AddMeet(const IntersectArguments& a,
             const Json& pair,
             const NurbsSurface& surface,
             const NurbsCurve<Dim>& curve,
             Meets& meets) {
  AddMeet(a, pair, curve, surface, meets, true);
}

template <int Dim, int Other>
void AddMeet(const IntersectArguments& a,
             const Json& pair,
             const NurbsCurve<Dim>& first,
             const NurbsCurve<Other>& second,
             Meets& meets) {
  const double tolerance = ToleranceFor(a, first, second);
  const auto met = IntersectCurves(InSpace(first), InSpace(second), tolerance);
  for (const CurveMeeting<3>& one : met.points) {
    meets.reached &= !a.tolerance || one.distance <= tolerance;
    Json entry{{"point", Numbers(one.point)},
               {"tangential", one.tangential},
               {"gap", one.distance},
               {"first", {one.first}},
               {"second", {one.second}}};
    if (!pair.is_null()) entry["index"] = pair;
    meets.points.push_back(entry);
  }
  for (const CurveOverlap& one : met.overlaps) {
    Json entry{{"first", {one.first.lower, one.first.upper}},
               {"second", {one.second.lower, one.second.upper}}};
    if (!pair.is_null()) entry["index"] = pair;
    meets.overlaps.push_back(entry);
  }
}

Meets MeetsOf(const IntersectArguments& a,
              const std::vector<Geometry>& first,
              const std::vector<Geometry>& second) {
  Meets meets;
  const bool several = first.size() > 1 || second.size() > 1;
  for (std::size_t i = 0; i < first.size(); ++i) {
    for (std::size_t j = 0; j < second.size(); ++j) {
      const Json pair = several ? Json{i, j} : Json(nullptr);
      std::visit([&](const auto& x, const auto& y) { AddMeet(a, pair, x, y, meets); },
                 first[i],
                 second[j]);
    }
  }
  return meets;
}

void PrintMeets(const Meets& meets) {
  for (const Json& one : meets.branches) {
    PrintResult(fmt::format("{} {} branch, length {:.8g}, off by {:.2g}",
                            one["closed"].get<bool>() ? "closed" : "open",
                            one["kind"].get<std::string>(),
                            one["length"].get<double>(),
                            one["deviation"].get<double>()));
  }
  for (const Json& one : meets.points) {
    const auto x = one["point"].get<std::vector<double>>();
    PrintResult(fmt::format("{} at {:.8g}, {:.8g}, {:.8g}",
                            one["tangential"].get<bool>() ? "touch" : "meet",
                            x[0],
                            x[1],
                            x[2]));
  }
  if (!meets.overlaps.empty()) PrintResult(fmt::format("coincident: {}", meets.overlaps.size()));
}

int RunIntersect(const IntersectArguments& a) {
  CheckDistinct({a.out}, a.flags.json);
  if (!a.out.empty()) {
    CheckGeometryFormat(a.out, a.out_format);
    CheckWritable(a.out);
  }
  if (a.first == "-" && a.second == "-") {
    throw UsageError("A and B can't both be standard input");
  }
  BeginReading({a.first, a.second}, a.flags.quiet);
  const GeometryContents first = ReadInUnit(a.first, a.format, a.output, a.flags.quiet);
  GeometryOutput same = a.output;
  const GeometryReadOptions beside = ReadBeside(a.output.unit, first.unit);
  same.unit = beside.unit;
  same.undeclared = beside.undeclared;
  const GeometryContents second = ReadInUnit(a.second, a.format, same, a.flags.quiet);
  const Meets meets = MeetsOf(a, first.geometry, second.geometry);
  ClearProgress();
  const bool none = meets.branches.empty() && meets.points.empty() && meets.overlaps.empty();
  Json result{{"branches", meets.branches},
              {"points", meets.points},
              {"overlaps", meets.overlaps},
              {"tolerance_reached", meets.reached}};
  if (!a.out.empty()) {
    if (meets.curves.empty()) {
      throw ReadError(
          a.first,
          "has no curve in common with " + a.second +
              (none                     ? ": they do not meet"
               : meets.overlaps.empty() ? ": they meet in points only"
                                        : ": they coincide; leave -o out to see where"));
    }
    const GeometryFile file{a.out, meets.curves};
    WriteGeometryFiles({file}, WriteOptions(a.out_format, same, first));
    result["files"] = Json::array({FileEntry(file)});
  }
  if (a.flags.json) {
    fmt::print("{}\n", JsonText(result, 2));
  } else if (!a.flags.quiet && a.out != "-") {
    PrintMeets(meets);
    if (none) PrintResult("they do not meet");
    if (result.contains("files")) PrintResult(FileLine(result["files"][0]));
    if (!meets.reached) PrintResult("tolerance not reached");
  }
  return meets.reached ? kDone : kToleranceMissed;
}

}  // namespace

void AddIntersectCommand(CLI::App& app, Action& action) {
  auto a = std::make_shared<IntersectArguments>();
  CLI::App& command = *app.add_subcommand(
      "intersect", "Where curves and surfaces meet: curves, points, what coincides");
  command.add_option("A", a->first, "Curves or surfaces: .json .step .iges .brep")->required();
  command.add_option("B", a->second, "What they are to meet")->required();
  command
      .add_option("-o,--output",
                  a->out,
                  "Where to write the curves of surfaces, in space: .step .iges .brep .json")
      ->type_name("OUT");
  command
      .add_option_function<std::string>(
          "--tolerance",
          [a](const std::string& text) {
            a->tolerance = ParseNumber("--tolerance", text, Sign::kPositive);
          },
          "How far curves may be from the surfaces, points from each other [1e-6 of the smaller "
          "size]")
      ->type_name("T");
  AddGeometryFormatFlag(
      command,
      a->format,
      "Format of A and B where a name does not tell, or of '-': json step iges brep");
  AddOutputFormatFlag(command, a->out_format);
  AddGeometryOutput(command, a->output);
  AddCommonFlags(command, a->flags);
  command.footer(
      "Surfaces meet in branches: transversal, tangential where they touch along a curve, overlap\n"
      "where they coincide beside an edge. They end at trims, borders and poles, and go on over\n"
      "seams and creases. --json gives kind, closed, length, deviation and the parameters at both\n"
      "ends on both surfaces. Curves meet curves and surfaces in points. What coincides is told "
      "by\n"
      "its intervals of parameters. Nothing to write in OUT: exit code 1, nothing written. A\n"
      "tolerance below the rounding of the coordinates is not reached: exit code 3.\n"
      "Examples:\n"
      "  batten intersect wing.step fuselage.step -o seam.step --tolerance 1e-4\n"
      "  batten intersect line.json part.step --json");
  command.callback([a, &action] { action = [a] { return RunIntersect(*a); }; });
}

}  // namespace batten::internal
