// SPDX-License-Identifier: MIT
#include "cli/arguments/make_joins.h"

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <variant>

#include "batten/geometry/blend.h"
#include "batten/geometry/fill.h"
#include "batten/geometry/joins.h"
#include "batten/io/read_error.h"
#include "cli/arguments/make_values.h"
#include "cli/arguments/plane_curves.h"
#include "cli/terminal/cli11.h"
#include "cli/terminal/offered_words.h"
#include "cli/terminal/parse_values.h"
#include "geometry/nurbs/placed_curve.h"

namespace batten::internal {
namespace {

using Shapes = std::vector<Geometry>;
using Json = nlohmann::ordered_json;

const std::vector<std::string> kEdgeWords = {"u0", "u1", "v0", "v1"};
const std::vector<std::string> kEndWords = {"start", "end"};

void AddBlend(CLI::App& command, MakeArguments& a) {
  command.add_option("GEOMETRY", a.files, "Two curves or two surfaces, in one file or in two")
      ->required()
      ->expected(1, 2);
  AddFlag(command, "--format", a.format, "FORMAT", "Format of files whose name does not tell");
  std::vector<std::string> words = kEdgeWords;
  words.insert(words.end(), kEndWords.begin(), kEndWords.end());
  Allow(*AddFlag(command,
                 "--from-edge",
                 a.first_end,
                 "EDGE",
                 "Where it begins: u0, u1, v0 or v1 of a surface, start or end of a curve [the "
                 "nearest pair]"),
        words);
  Allow(*AddFlag(command, "--to-edge", a.second_end, "EDGE", "Where it ends"), words);
  Allow(*AddFlag(command, "--continuity", a.continuity, "G", "G0, G1 or G2 at both ends"),
        {"0", "1", "2"});
  AddFlag(command,
          "--fullness",
          a.fullness,
          "F[,F]",
          "How far the directions of the shapes are followed, in widths of the gap");
}

std::pair<Geometry, Geometry> TwoShapes(const MakeArguments& a) {
  Shapes shapes;
  for (const std::string& path : a.files) {
    for (Geometry& one : a.unit->Read(path, a.format)) shapes.push_back(std::move(one));
  }
  if (shapes.size() != 2) {
    throw UsageError("the files hold " + std::to_string(shapes.size()) +
                     " geometries; a blend is between two");
  }
  MatchDimensions(shapes);
  if (shapes[0].index() != shapes[1].index()) {
    throw UsageError("a blend is between two curves or two surfaces, not one of each");
  }
  return {std::move(shapes[0]), std::move(shapes[1])};
}

BlendOptions OptionsOf(const MakeArguments& a) {
  const std::vector<double> fullness = ParseNumbers("--fullness", a.fullness);
  if (fullness.size() > 2) throw UsageError("--fullness: one number, or one for each end");
  return {.continuity = std::stoi(a.continuity), .fullness = {fullness.front(), fullness.back()}};
}

std::optional<SurfaceEdge> EdgeOf(const char* flag, const std::string& word) {
  if (word.empty()) return std::nullopt;
  if (word.size() != 2) throw UsageError(std::string(flag) + ": a surface has u0, u1, v0 and v1");
  return SurfaceEdge{word[0] == 'u' ? Direction::kU : Direction::kV, word[1] == '1'};
}

std::optional<CurveEnds> EndsOf(const MakeArguments& a) {
  if (a.first_end.empty() && a.second_end.empty()) return std::nullopt;
  for (const std::string& word : {a.first_end, a.second_end}) {
    if (word != "start" && word != "end") {
      throw UsageError("--from-edge and --to-edge: of curves both, start or end");
    }
  }
  return CurveEnds{a.first_end == "end", a.second_end == "end"};
}

struct Blender {
  const MakeArguments& a;

  template <int Dim>
  Shapes operator()(const NurbsCurve<Dim>& first, const NurbsCurve<Dim>& second) const {
    return {Blend(first, second, OptionsOf(a), EndsOf(a))};
  }
  Shapes operator()(const NurbsSurface& first, const NurbsSurface& second) const {
    return {Blend(first,
                  second,
                  OptionsOf(a),
                  EdgeOf("--from-edge", a.first_end),
                  EdgeOf("--to-edge", a.second_end))
                .surface};
  }
  template <typename First, typename Second>
  Shapes operator()(const First&, const Second&) const {
    return {};
  }
};

Shapes Blended(const MakeArguments& a) {
  const auto [first, second] = TwoShapes(a);
  return std::visit(Blender{a}, first, second);
}

Json JoinJson(const JoinQuality& join) {
  Json json{{"G", join.geometric}, {"position_gap", join.position_gap}};
  json["angle_gap"] = join.angle_gap ? Json(*join.angle_gap) : Json(nullptr);
  json["curvature_gap"] = join.curvature_gap ? Json(*join.curvature_gap) : Json(nullptr);
  return json;
}

struct JoinMeasurer {
  template <int Dim>
  Json operator()(const NurbsCurve<Dim>& shape, const NurbsCurve<Dim>& blend) const {
    return JoinJson(TestJoin(shape, blend));
  }
  Json operator()(const NurbsSurface& shape, const NurbsSurface& blend) const {
    return JoinJson(TestJoin(shape, blend));
  }
  template <typename First, typename Second>
  Json operator()(const First&, const Second&) const {
    return nullptr;
  }
};

// How the blend meets both shapes, by the test of joins.
Json Joins(const MakeArguments& a, const Shapes& made) {
  const auto [first, second] = TwoShapes(a);
  const Json from = std::visit(JoinMeasurer{}, first, made[0]);
  const Json to = std::visit(JoinMeasurer{}, second, made[0]);
  const int asked = std::stoi(a.continuity);
  Json said{{"join_from", from}, {"join_to", to}};
  said["tolerance_reached"] = from["G"] >= asked && to["G"] >= asked;
  return said;
}

void AddFill(CLI::App& command, MakeArguments& a) {
  command
      .add_option("SIDE",
                  a.files,
                  "Files of curves, and edges of surfaces to go on from, as wall.json:u1: three to "
                  "six sides in any order")
      ->required();
  AddFlag(command, "--format", a.format, "FORMAT", "Format of files whose name does not tell");
  AddFlag(command,
          "--tolerance",
          a.tolerance,
          "T",
          "The widest gap, between sides and from them [1e-6 of the size]");
  AddFlag(command,
          "--angle-tolerance",
          a.angle_tolerance,
          "DEGREES",
          "Between tangent planes across edges [0.006]");
}

// "wall.json:u1" is the edge u1 of the only surface in wall.json.
void AddSides(const MakeArguments& a, const std::string& text, std::vector<FillSide>& sides) {
  const size_t colon = text.rfind(':');
  const std::string word = colon == std::string::npos ? "" : text.substr(colon + 1);
  const bool edge = std::find(kEdgeWords.begin(), kEdgeWords.end(), word) != kEdgeWords.end();
  if (!edge && colon != std::string::npos && !std::filesystem::exists(text) &&
      std::filesystem::exists(text.substr(0, colon))) {
    throw UsageError(text + ": '" + word + "' is no edge of a surface; they are u0, u1, v0 and v1");
  }
  const std::string path = edge ? text.substr(0, colon) : text;
  Shapes shapes = a.unit->Read(path, a.format);
  if (edge) {
    const auto* surface = std::get_if<NurbsSurface>(&shapes[0]);
    if (shapes.size() != 1 || !surface)
      throw UsageError(path + ": does not hold one surface alone");
    sides.push_back(SideOf(*surface, *EdgeOf("SIDE", word)));
    return;
  }
  for (const Geometry& one : shapes) {
    if (std::holds_alternative<NurbsSurface>(one)) {
      throw UsageError(path + ": holds a surface; name its edge, as in " + path + ":u1");
    }
    const auto* flat = std::get_if<NurbsCurve<2>>(&one);
    sides.push_back({flat ? InSpace(*flat) : std::get<NurbsCurve<3>>(one)});
  }
}

std::vector<FillSide> SidesOf(const MakeArguments& a) {
  std::vector<FillSide> sides;
  for (const std::string& text : a.files) AddSides(a, text, sides);
  return sides;
}

FillOptions FillOptionsOf(const MakeArguments& a) {
  FillOptions options;
  if (!a.tolerance.empty()) options.tolerance = Length("--tolerance", a.tolerance);
  if (!a.angle_tolerance.empty()) {
    options.angle_tolerance = Radians(Length("--angle-tolerance", a.angle_tolerance));
  }
  return options;
}

Shapes Filled(const MakeArguments& a) {
  Shapes shapes;
  for (NurbsSurface& patch : Fill(SidesOf(a), FillOptionsOf(a)).patches) {
    shapes.emplace_back(std::move(patch));
  }
  return shapes;
}

Json QualityOfFill(const MakeArguments& a, const Shapes& made) {
  std::vector<NurbsSurface> patches;
  for (const Geometry& one : made) patches.push_back(std::get<NurbsSurface>(one));
  const std::vector<FillSide> sides = SidesOf(a);
  const FillOptions options = FillOptionsOf(a);
  const FillQuality quality = MeasureFill(patches, sides, options);
  return {{"position_gap", quality.position_gap},
          {"inner_angle", quality.inner_angle},
          {"outer_angle", quality.outer_angle},
          {"tolerance_reached",
           quality.Within(FillTolerance(sides, options), options.angle_tolerance)}};
}

}  // namespace

MakeKind FillKind() {
  return {"fill",
          "The surfaces that fill a hole of three to six sides, tangent to its neighbours",
          "fill wall.json:u1 roof.json:v0 edge.json -o corner.step",
          AddFill,
          Filled,
          QualityOfFill};
}

MakeKind BlendKind() {
  return {"blend",
          "The curve or surface between two, meeting both with tangents or curvatures",
          "blend roof.json wall.json -o fillet.step --from-edge u1 --to-edge v0 --fullness 0.8",
          AddBlend,
          Blended,
          Joins};
}

}  // namespace batten::internal
