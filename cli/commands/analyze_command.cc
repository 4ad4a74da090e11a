// SPDX-License-Identifier: MIT
// batten analyze: what a curve or surface is, and how two of them meet.
#include <fmt/format.h>

#include <array>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "batten/geometry/classify_shape.h"
#include "batten/geometry/closure.h"
#include "batten/geometry/joins.h"
#include "batten/io/geometry_file.h"
#include "batten/io/read_error.h"
#include "cli/arguments/geometry_flags.h"
#include "cli/arguments/geometry_output.h"
#include "cli/arguments/geometry_summary.h"
#include "cli/arguments/shared_unit.h"
#include "cli/arguments/short_summary.h"
#include "cli/commands/commands.h"
#include "cli/terminal/cli11.h"
#include "cli/terminal/common_flags.h"
#include "cli/terminal/exit_codes.h"
#include "cli/terminal/parse_values.h"
#include "cli/terminal/terminal.h"
#include "geometry/numeric/number_text.h"

namespace batten::internal {
namespace {

using Json = nlohmann::ordered_json;

struct AnalyzeArguments {
  std::string first, second, format;
  std::optional<double> tolerance;
  JoinOptions join;
  bool joins_only = false;  // a flag of joins was given
  bool all = false;
  GeometryInput input;
  CommonFlags flags;
};

Json OrNull(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }

Json QualityJson(const JoinQuality& join) {
  return {{"C", join.parametric},
          {"G", join.geometric},
          {"position_gap", join.position_gap},
          {"angle_gap", OrNull(join.angle_gap)},
          {"curvature_gap", OrNull(join.curvature_gap)}};
}

Json JoinJson(const CurveJoin& join) {
  Json json = QualityJson(join);
  json["at"] = join.at;
  return json;
}

std::string EdgeName(const NurbsSurface& surface, const SurfaceEdge& edge) {
  const bool u = edge.direction == Direction::kU;
  const SplineBasis& basis = u ? surface.basis_u() : surface.basis_v();
  return (u ? "u=" : "v=") + NumberText(edge.upper ? basis.upper() : basis.lower());
}

Json JoinJson(const NurbsSurface& first, const NurbsSurface& second, const SurfaceJoin& join) {
  Json json = QualityJson(join);
  json["at"] = Json::array();
  for (const Eigen::Vector2d& at : join.at) json["at"].push_back(std::array{at[0], at[1]});
  json["edges"] = {EdgeName(first, join.edges[0]), EdgeName(second, join.edges[1])};
  json["reversed"] = join.reversed;
  json["shared_edges"] = join.shared_edges;
  return json;
}

// The same shape twice is asked how it closes: a surface in every direction that does, in u where
// none does.
template <int Dim>
std::vector<Json> Seams(const NurbsCurve<Dim>& curve, const JoinOptions& options) {
  return {Json{{"join", JoinJson(TestSeam(curve, options))}}};
}

std::vector<Json> Seams(const NurbsSurface& surface, const JoinOptions& options) {
  std::vector<Json> seams;
  const bool in_u = Closed(surface, Direction::kU), in_v = Closed(surface, Direction::kV);
  for (const Direction direction : {Direction::kU, Direction::kV}) {
    const bool u = direction == Direction::kU;
    if (!(u ? in_u || !in_v : in_v)) continue;
    seams.push_back(
        Json{{"direction", u ? "u" : "v"},
             {"join", JoinJson(surface, surface, TestSeam(surface, direction, options))}});
  }
  return seams;
}

struct Joiner {
  const AnalyzeArguments& a;

  template <int Dim>
  std::vector<Json> operator()(const NurbsCurve<Dim>& first, const NurbsCurve<Dim>& second) const {
    if (first == second) return Seams(first, a.join);
    return {Json{{"join", JoinJson(TestJoin(first, second, a.join))}}};
  }
  std::vector<Json> operator()(const NurbsSurface& first, const NurbsSurface& second) const {
    if (first == second) return Seams(first, a.join);
    return {Json{{"join", JoinJson(first, second, TestJoin(first, second, a.join))}}};
  }
  template <typename First, typename Second>
  std::vector<Json> operator()(const First&, const Second&) const {
    throw ReadError(a.second,
                    "can't be joined with " + a.first +
                        ": two curves of one dimension or two surfaces are needed");
  }
};

// Of every geometry of the first file with every one of the second.
Json JoinsOf(const AnalyzeArguments& a,
             const std::vector<Geometry>& first,
             const std::vector<Geometry>& second) {
  std::vector<Json> results;
  const bool single = first.size() == 1 && second.size() == 1;
  for (size_t i = 0; i < first.size(); ++i) {
    for (size_t j = 0; j < second.size(); ++j) {
      for (Json& one : std::visit(Joiner{a}, first[i], second[j])) {
        Json result;
        if (!single) result["index"] = {i, j};
        result.update(one);
        results.push_back(std::move(result));
      }
    }
  }
  return results.size() == 1 ? results.front() : Json{{"results", results}};
}

Json Analysis(const AnalyzeArguments& a) {
  if (a.second.empty()) {
    if (a.joins_only) {
      throw UsageError(
          "the tolerances of joins need a second geometry: analyze GEOMETRY GEOMETRY2");
    }
    const GeometryContents contents =
        ReadGeometryContents(a.first, {.format = a.format, .strict = a.input.strict});
    TellUnread(a.first, contents, a.input, a.flags.quiet);
    return SummaryOf(contents, a.tolerance.value_or(ClassifyOptions().tolerance));
  }
  if (a.tolerance)
    throw UsageError("--tolerance is of one geometry; for joins --position-tolerance");
  if (a.first == "-" && a.second == "-") {
    throw UsageError("GEOMETRY and GEOMETRY2 can't both be standard input");
  }
  SharedUnit unit;
  const std::vector<Geometry> first = unit.Read(a.first, a.format);
  return JoinsOf(a, first, unit.Read(a.second, a.format));
}

int RunAnalyze(const AnalyzeArguments& a) {
  BeginReading(a.second.empty() ? std::vector{a.first} : std::vector{a.first, a.second},
               a.flags.quiet);
  const Json analysis = Analysis(a);
  ClearProgress();
  if (a.flags.json) {
    fmt::print("{}\n", JsonText(analysis, 2));
  } else if (!a.flags.quiet) {
    if (a.second.empty()) {
      PrintForPeople(analysis, a.all);
    } else {
      PrintAligned(analysis);
    }
  }
  return kDone;
}

void AddTolerances(CLI::App& command, const std::shared_ptr<AnalyzeArguments>& a) {
  const auto add = [&](const std::string& flag, const std::string& help, auto set) {
    return command.add_option_function<std::string>(
        flag,
        [flag, set](const std::string& text) { set(ParseNumber(flag, text, Sign::kPositive)); },
        help);
  };
  const auto number = [](double x) { return NumberText(x); };
  constexpr double kDegree = std::numbers::pi / 180;
  add("--tolerance",
      "How far a shape may be from the line, circle, plane … it is called, relative to its size",
      [a](double x) { a->tolerance = x; })
      ->type_name("T")
      ->default_str(number(ClassifyOptions().tolerance));
  add("--position-tolerance",
      "Joins: the widest gap, in the data's unit [1e-9 of the size]",
      [a](double x) {
        a->join.position_tolerance = x;
        a->joins_only = true;
      })
      ->type_name("T");
  add("--angle-tolerance",
      "Joins: the largest angle between tangents, in degrees",
      [a](double x) {
        a->join.angle_tolerance = x * kDegree;
        a->joins_only = true;
      })
      ->type_name("A")
      ->default_str(fmt::format("{:.6g}", JoinOptions().angle_tolerance / kDegree));
  add("--curvature-tolerance",
      "Joins: the largest difference of curvatures, relative to them",
      [a](double x) {
        a->join.curvature_tolerance = x;
        a->joins_only = true;
      })
      ->type_name("T")
      ->default_str(number(JoinOptions().curvature_tolerance));
  add("--derivative-tolerance",
      "Joins: the largest difference of derivatives, relative to them",
      [a](double x) {
        a->join.derivative_tolerance = x;
        a->joins_only = true;
      })
      ->type_name("T")
      ->default_str(number(JoinOptions().derivative_tolerance));
}

}  // namespace

void AddAnalyzeCommand(CLI::App& app, Action& action) {
  auto a = std::make_shared<AnalyzeArguments>();
  CLI::App& command =
      *app.add_subcommand("analyze", "What a curve or surface is, or how two of them meet");
  command.add_option("GEOMETRY", a->first, "Curves or surfaces: .json .step .iges .brep")
      ->required();
  command.add_option("GEOMETRY2",
                     a->second,
                     "A second one: C0 … C2 and G0 … G2 where they meet; the same one again: where "
                     "it closes");
  command.add_flag("--all", a->all, "Print every number, knots and domains too");
  AddTolerances(command, a);
  AddGeometryFormatFlag(command,
                        a->format,
                        "Format of '-' or of a file whose name does not tell: json step iges brep");
  AddGeometryInput(command, a->input);
  AddCommonFlags(command, a->flags);
  command.footer(
      "Degree, size, length or area, range of curvature, and what shape it is: line,\n"
      "circle, ellipse, parabola, hyperbola; plane, cylinder, sphere, cone, torus, revolution,\n"
      "extrusion; free. Gaps of joins: in the data's unit, in radians, in one over the unit.\n"
      "Examples:\n"
      "  batten analyze part.step\n"
      "  batten analyze part.step --all\n"
      "  batten analyze arc.json --json\n"
      "  batten analyze left.json right.json --angle-tolerance 0.1\n"
      "  batten analyze tube.json tube.json");
  command.callback([a, &action] { action = [a] { return RunAnalyze(*a); }; });
}

}  // namespace batten::internal
