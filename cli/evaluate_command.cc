// SPDX-License-Identifier: MIT
// batten evaluate: points, derivatives, normals and curvature at parameters.
#include <fmt/format.h>

#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "batten/cli/program.h"
#include "batten/geometry/curvature.h"
#include "batten/io/geometry_file.h"
#include "batten/io/read_error.h"

namespace batten {
namespace {

using Json = nlohmann::ordered_json;

struct Arguments {
  std::string geometry, at_file, format;
  std::vector<std::string> at;
  int derivatives = 0;
  CommonFlags flags;
};

template <typename Vector>
Json ToJson(const Vector& v) {
  Json array = Json::array();
  for (Eigen::Index k = 0; k < v.size(); ++k) array.push_back(v[k]);
  return array;
}

void RequireInside(const SplineBasis& basis, double parameter, const char* name) {
  if (parameter >= basis.lower() && parameter <= basis.upper()) return;
  throw UsageError(fmt::format("--at: {} = {} is outside the domain [{}, {}]", name, parameter, basis.lower(), basis.upper()));
}

template <int Dim>
Json Evaluate(const NurbsCurve<Dim>& curve, const std::vector<double>& at, int order) {
  if (at.size() != 1) throw UsageError("--at: a curve has one parameter, not " + std::to_string(at.size()));
  RequireInside(curve.basis(), at[0], "u");
  const auto derivatives = curve.Derivatives(at[0], std::max(order, 3));
  Json result{{"at", at}, {"point", ToJson(derivatives.col(0))}, {"derivatives", Json::array()}};
  for (int k = 0; k <= order; ++k) result["derivatives"].push_back(ToJson(derivatives.col(k)));
  if (order >= 2) {
    Eigen::Matrix3d space = Eigen::Matrix3d::Zero();
    space.topRows<Dim>() = derivatives.template middleCols<3>(1);
    const auto curvature = CurvatureOf(Eigen::Vector3d(space.col(0)), space.col(1), space.col(2));
    result["curvature"] = nullptr;
    if (curvature) result["curvature"] = {{"curvature", curvature->curvature}, {"torsion", curvature->torsion}};
  }
  return result;
}

Json Evaluate(const NurbsSurface& surface, const std::vector<double>& at, int order) {
  if (at.size() != 2) throw UsageError("--at: a surface has two parameters u,v, not " + std::to_string(at.size()));
  RequireInside(surface.basis_u(), at[0], "u");
  RequireInside(surface.basis_v(), at[1], "v");
  const SurfaceDerivatives derivatives = surface.Derivatives(at[0], at[1], order);
  Json result{{"at", at}, {"point", ToJson(derivatives(0, 0))}, {"derivatives", Json::array()}};
  for (int k = 0; k <= order; ++k) {
    Json row = Json::array();
    for (int l = 0; k + l <= order; ++l) row.push_back(ToJson(derivatives(k, l)));
    result["derivatives"].push_back(row);
  }
  const SurfaceJet jet = surface.JetAt(at[0], at[1]);
  const auto normal = UnitNormal(jet);
  result["normal"] = normal ? ToJson(*normal) : Json(nullptr);
  if (order >= 2) {
    const auto c = CurvatureOf(jet);
    result["curvature"] = nullptr;
    if (c) {
      result["curvature"] = {{"gaussian", c->gaussian}, {"mean", c->mean},
                             {"principal", {c->principal_low, c->principal_high}}};
    }
  }
  return result;
}

std::vector<std::vector<double>> Parameters(const Arguments& a) {
  std::vector<std::vector<double>> parameters;
  for (const std::string& text : a.at) parameters.push_back(ParseNumbers("--at", text));
  if (!a.at_file.empty()) {
    std::ifstream file(a.at_file);
    if (!file) throw ReadError(a.at_file, "can't be opened");
    std::string line;
    for (std::int64_t number = 1; std::getline(file, line); ++number) {
      if (!line.empty() && line.back() == '\r') line.pop_back();
      if (line.find_first_not_of(" \t") == std::string::npos || line[0] == '#') continue;
      try {
        parameters.push_back(ParseNumbers("--at-file", line));
      } catch (const UsageError& error) {
        if (number == 1) continue;  // a header of names
        throw ReadError::AtLine(a.at_file, number, error.what());
      }
    }
  }
  if (parameters.empty()) throw UsageError("evaluate needs parameters: --at u[,v] or --at-file F.csv");
  return parameters;
}

void Print(const Json& value, const std::string& indent) {
  for (const auto& [key, entry] : value.items()) {
    if (entry.is_object()) {
      fmt::print("{}{}\n", indent, key);
      Print(entry, indent + "  ");
    } else {
      fmt::print("{}{:<12} {}\n", indent, key, entry.dump());
    }
  }
}

int Run(const Arguments& a) {
  constexpr int kMostDerivatives = 50;
  if (a.derivatives < 0 || a.derivatives > kMostDerivatives) {
    throw UsageError(fmt::format("--derivatives: {} is not from 0 to {}", a.derivatives, kMostDerivatives));
  }
  const std::vector<std::vector<double>> parameters = Parameters(a);
  const std::vector<Geometry> geometry = ReadGeometry(a.geometry, {a.format});
  Json results = Json::array();
  for (size_t g = 0; g < geometry.size(); ++g) {
    for (const std::vector<double>& at : parameters) {
      Json one = std::visit([&](const auto& shape) { return Evaluate(shape, at, a.derivatives); }, geometry[g]);
      if (geometry.size() > 1) one["index"] = g;
      results.push_back(std::move(one));
    }
  }
  if (a.flags.json) {
    fmt::print("{}\n", Json{{"results", results}}.dump(2));
  } else if (!a.flags.quiet) {
    for (const Json& one : results) Print(one, "");
  }
  return kDone;
}

}  // namespace

void AddEvaluateCommand(CLI::App& app, Action& action) {
  auto a = std::make_shared<Arguments>();
  CLI::App& command = *app.add_subcommand("evaluate", "Points, derivatives, normals and curvature at parameters");
  command.add_option("GEOMETRY", a->geometry, "Curves or surfaces: .json .step")->required();
  command.add_option("--at", a->at, "Parameters u or u,v; may be given again")->type_name("u[,v]");
  command.add_option("--at-file", a->at_file, "Parameters, a row each")->type_name("F.csv");
  command.add_option("--derivatives", a->derivatives, "Derivatives up to this order; from 2 on curvature too")->capture_default_str()
      ->type_name("K");
  command.add_option("--format", a->format, "Format of '-' or of a file whose name does not tell: json step")
      ->type_name("FORMAT");
  AddCommonFlags(command, a->flags);
  command.footer("Examples:\n  batten evaluate part.json --at 0.5,0.25 --derivatives 2 --json\n  batten evaluate curve.step --at 0 --at 1");
  command.callback([a, &action] { action = [a] { return Run(*a); }; });
}

}  // namespace batten
