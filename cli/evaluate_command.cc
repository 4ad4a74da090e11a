// SPDX-License-Identifier: MIT
// batten evaluate: points, derivatives, normals and curvature at parameters.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>

#include "batten/cli/parse_values.h"
#include "batten/cli/program.h"
#include "batten/geometry/curvature.h"
#include "batten/io/geometry_file.h"
#include "batten/io/read_error.h"
#include "batten/io/whole_file.h"

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

// Parameters asked for, and where: "--at" or a line of a file.
struct Request {
  std::vector<double> at;
  std::string file;
  std::int64_t line = 0;

  // A flag's value is usage, a file's line is input.
  [[noreturn]] void Refuse(const std::string& reason) const {
    if (line > 0) throw ReadError::AtLine(file, line, reason);
    throw UsageError("--at: " + reason);
  }
};

void RequireCount(const Request& request, size_t count, const char* rule) {
  if (request.at.size() != count)
    request.Refuse(fmt::format("{}, not {}", rule, request.at.size()));
}

void RequireInside(const Request& request,
                   const SplineBasis& basis,
                   double parameter,
                   const char* name) {
  if (parameter >= basis.lower() && parameter <= basis.upper()) return;
  request.Refuse(fmt::format(
      "{} = {} is outside the domain [{}, {}]", name, parameter, basis.lower(), basis.upper()));
}

template <int Dim>
Json Evaluate(const NurbsCurve<Dim>& curve, const Request& request, int order) {
  RequireCount(request, 1, "a curve has one parameter u");
  const std::vector<double>& at = request.at;
  RequireInside(request, curve.basis(), at[0], "u");
  const auto derivatives = curve.Derivatives(at[0], std::max(order, 3));
  Json result{{"at", at}, {"point", ToJson(derivatives.col(0))}, {"derivatives", Json::array()}};
  for (int k = 0; k <= order; ++k) result["derivatives"].push_back(ToJson(derivatives.col(k)));
  if (order >= 2) {
    Eigen::Matrix3d space = Eigen::Matrix3d::Zero();
    space.topRows<Dim>() = derivatives.template middleCols<3>(1);
    const auto curvature = CurvatureOf(Eigen::Vector3d(space.col(0)), space.col(1), space.col(2));
    result["curvature"] = nullptr;
    if (curvature)
      result["curvature"] = {{"curvature", curvature->curvature}, {"torsion", curvature->torsion}};
  }
  return result;
}

Json Evaluate(const NurbsSurface& surface, const Request& request, int order) {
  RequireCount(request, 2, "a surface has two parameters u,v");
  const std::vector<double>& at = request.at;
  RequireInside(request, surface.basis_u(), at[0], "u");
  RequireInside(request, surface.basis_v(), at[1], "v");
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
      result["curvature"] = {{"gaussian", c->gaussian},
                             {"mean", c->mean},
                             {"principal", {c->principal_low, c->principal_high}}};
    }
  }
  return result;
}

// Rows of one or two numbers, separated by commas, semicolons or blanks; # comments; a header of
// names.
void ReadRequests(const std::string& path, std::vector<Request>& requests) {
  std::istringstream rows(ReadWholeFile(path));
  const size_t before = requests.size();
  std::string row;
  for (std::int64_t line = 1; std::getline(rows, row); ++line) {
    row.erase(std::min(row.find('#'), row.size()));
    std::replace_if(
        row.begin(),
        row.end(),
        [](char c) { return c == ',' || c == ';' || c == '\t' || c == '\r'; },
        ' ');
    std::string numbers;
    std::istringstream words(row);
    for (std::string word; words >> word;) numbers += (numbers.empty() ? "" : ",") + word;
    if (numbers.empty()) continue;
    try {
      requests.push_back({ParseNumbers("parameters", numbers), path, line});
    } catch (const UsageError&) {
      if (requests.size() == before && std::isalpha(static_cast<unsigned char>(numbers[0])))
        continue;  // names
      throw ReadError::AtLine(path, line, "parameters u[,v] expected");
    }
  }
  if (requests.size() == before) throw ReadError(path, "holds no parameters");
}

std::vector<Request> Requests(const Arguments& a) {
  std::vector<Request> requests;
  for (const std::string& text : a.at) requests.push_back({ParseNumbers("--at", text), "", 0});
  if (!a.at_file.empty()) ReadRequests(a.at_file, requests);
  if (requests.empty())
    throw UsageError("evaluate needs parameters: --at u[,v] or --at-file F.csv");
  return requests;
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
  const std::vector<Request> requests = Requests(a);
  const std::vector<Geometry> geometry = ReadGeometry(a.geometry, {a.format});
  Json results = Json::array();
  for (size_t g = 0; g < geometry.size(); ++g) {
    for (const Request& request : requests) {
      Json one = std::visit(
          [&](const auto& shape) { return Evaluate(shape, request, a.derivatives); }, geometry[g]);
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
  CLI::App& command =
      *app.add_subcommand("evaluate", "Points, derivatives, normals and curvature at parameters");
  command.add_option("GEOMETRY", a->geometry, "Curves or surfaces: .json .step")->required();
  command.add_option("--at", a->at, "Parameters u or u,v; may be given again")->type_name("u[,v]");
  command.add_option("--at-file", a->at_file, "Parameters, a row each; - is standard input")
      ->type_name("F.csv");
  constexpr int kMostDerivatives = 50;
  command
      .add_option_function<std::string>(
          "--derivatives",
          [a](const std::string& text) {
            a->derivatives =
                static_cast<int>(ParseWhole("--derivatives", text, 0, kMostDerivatives));
          },
          "Derivatives up to this order; from 2 on curvature too")
      ->default_str("0")
      ->type_name("K");
  command
      .add_option(
          "--format", a->format, "Format of '-' or of a file whose name does not tell: json step")
      ->type_name("FORMAT");
  AddCommonFlags(command, a->flags);
  command.footer(
      "Examples:\n  batten evaluate part.json --at 0.5,0.25 --derivatives 2 --json\n  batten "
      "evaluate curve.step --at 0 --at 1");
  command.callback([a, &action] { action = [a] { return Run(*a); }; });
}

}  // namespace batten
