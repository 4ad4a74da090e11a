// SPDX-License-Identifier: MIT
// batten evaluate: points, derivatives, normals and curvature at parameters.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <utility>

#include "batten/geometry/trim_region.h"
#include "batten/io/geometry_file.h"
#include "batten/io/read_error.h"
#include "cli/arguments/geometry_flags.h"
#include "cli/commands/commands.h"
#include "cli/terminal/cli11.h"
#include "cli/terminal/common_flags.h"
#include "cli/terminal/exit_codes.h"
#include "cli/terminal/parse_values.h"
#include "cli/terminal/terminal.h"
#include "io/base/whole_file.h"
#include "io/report/evaluation.h"

namespace batten::internal {
namespace {

struct EvaluateArguments {
  std::string geometry, at_file, format;
  std::vector<std::string> at;
  int derivatives = 0;
  std::string along;
  CommonFlags flags;
};

EvaluationQuestion QuestionOf(const EvaluateArguments& a) {
  EvaluationQuestion question{a.derivatives, std::nullopt};
  if (a.along.empty()) return question;
  const std::vector<double> numbers = ParseNumbers("--along", a.along);
  if (numbers.size() != 3) throw UsageError("--along: '" + a.along + "' is not a vector x,y,z");
  question.along = Eigen::Vector3d(numbers.data());
  return question;
}

// Parameters asked for, and where: "--at" or a line of a file.
struct Request {
  std::vector<double> at;
  std::string file;
  std::int64_t line = 0;

  // A flag's value is usage, a file's line is input.
  [[noreturn]] void Refuse(const std::string& reason) const {
    if (line > 0) throw ReadError::AtLine(file, line, reason);
    throw UsageError("evaluate --at: " + reason);
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
  if (basis.periodic() || (parameter >= basis.lower() && parameter <= basis.upper())) return;
  request.Refuse(fmt::format(
      "{} = {} is outside the domain [{}, {}]", name, parameter, basis.lower(), basis.upper()));
}

// Whether the shape has these parameters; periodic directions take any.
template <int Dim>
void Check(const NurbsCurve<Dim>& curve, const Request& request) {
  RequireCount(request, 1, "a curve has one parameter u");
  RequireInside(request, curve.basis(), request.at[0], "u");
}
void Check(const NurbsSurface& surface, const Request& request) {
  RequireCount(request, 2, "a surface has two parameters u,v");
  RequireInside(request, surface.basis_u(), request.at[0], "u");
  RequireInside(request, surface.basis_v(), request.at[1], "v");
}

// What is inside a geometry's trims; none where it has none.
struct RegionOf {
  template <int Dim>
  std::optional<TrimRegion> operator()(const NurbsCurve<Dim>&) const {
    return std::nullopt;
  }
  std::optional<TrimRegion> operator()(const NurbsSurface& surface) const {
    if (!surface.trimmed()) return std::nullopt;
    return TrimRegion(surface);
  }
};

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

std::vector<Request> Requests(const EvaluateArguments& a) {
  std::vector<Request> requests;
  for (const std::string& text : a.at) requests.push_back({ParseNumbers("--at", text), "", 0});
  if (!a.at_file.empty()) ReadRequests(a.at_file, requests);
  if (requests.empty())
    throw UsageError("evaluate needs parameters: --at u[,v] or --at-file F.csv");
  return requests;
}

// A word about which of several geometries refused.
void CheckAll(const std::vector<Geometry>& geometry, const std::vector<Request>& requests) {
  for (size_t g = 0; g < geometry.size(); ++g) {
    for (const Request& request : requests) {
      try {
        std::visit([&](const auto& shape) { Check(shape, request); }, geometry[g]);
      } catch (const UsageError& error) {
        if (geometry.size() == 1) throw;
        throw UsageError(fmt::format("{} (geometry of index {})", error.what(), g));
      }
    }
  }
}

// Results are printed as they are computed: a million of them take no memory.
int RunEvaluate(const EvaluateArguments& a) {
  const EvaluationQuestion question = QuestionOf(a);
  const std::vector<Request> requests = Requests(a);
  BeginReading({a.geometry}, a.flags.quiet);
  const std::vector<Geometry> geometry = ReadGeometry(a.geometry, {a.format});
  CheckAll(geometry, requests);
  if (question.along && !std::any_of(geometry.begin(), geometry.end(), [](const Geometry& one) {
        return std::holds_alternative<NurbsSurface>(one);
      })) {
    throw UsageError("--along is for surfaces: " + a.geometry + " holds none");
  }
  const Progress progress = MakeProgress(a.flags.quiet);
  if (a.flags.json) fmt::print("{{\"results\": [");
  bool first = true;
  for (size_t g = 0; g < geometry.size(); ++g) {
    const std::optional<TrimRegion> region = std::visit(RegionOf(), geometry[g]);
    for (const Request& request : requests) {
      Report(progress, "evaluate", static_cast<double>(g) / static_cast<double>(geometry.size()));
      nlohmann::ordered_json result =
          Evaluation(geometry[g], region ? &*region : nullptr, request.at, question);
      if (geometry.size() > 1) result["index"] = g;
      ClearProgress();
      if (a.flags.json) {
        fmt::print("{}\n  {}", std::exchange(first, false) ? "" : ",", result.dump());
      } else if (!a.flags.quiet) {
        fmt::print("{}", EvaluationText(result));
      }
    }
  }
  if (a.flags.json) fmt::print("\n]}}\n");
  return kDone;
}

}  // namespace

void AddEvaluateCommand(CLI::App& app, Action& action) {
  auto a = std::make_shared<EvaluateArguments>();
  CLI::App& command =
      *app.add_subcommand("evaluate", "Points, derivatives, normals and curvature at parameters");
  command.add_option("GEOMETRY", a->geometry, "Curves or surfaces: .json .step .iges .brep")
      ->required();
  command.add_option("--at", a->at, "Parameters u or u,v; may be given again")
      ->type_name("u[,v]")
      ->allow_extra_args(false);
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
          "Derivatives up to this order; from 2 on curvature and torsion too")
      ->default_str("0")
      ->type_name("K");
  command
      .add_option(
          "--along",
          a->along,
          "A vector: the steps du and dv of surfaces' parameters that go along it, and what "
          "of it no step gives")
      ->type_name("x,y,z");
  AddGeometryFormatFlag(command,
                        a->format,
                        "Format of '-' or of a file whose name does not tell: json step iges brep");
  AddCommonFlags(command, a->flags);
  command.footer(
      "Derivatives are from the right at knots and from the left at the upper end. A parameter\n"
      "outside the domain is refused; in a periodic direction it is taken whole periods away.\n"
      "Normals are S_u x S_v / |...|. They and curvatures are limits at collapsed edges, and none\n"
      "where there is no limit. On a trimmed surface 'inside' says whether the point counts.\n"
      "Examples:\n"
      "  batten evaluate part.json --at 0.5,0.25\n"
      "  batten evaluate part.json --at 0.5,0.25 --derivatives 2 --json     with curvature\n"
      "  batten evaluate part.json --at 0.5,0.25 --along 1,0,0\n"
      "  batten evaluate curve.step --at 0 --at 1\n"
      "  batten evaluate curve.json --at-file parameters.csv --json");
  command.callback([a, &action] { action = [a] { return RunEvaluate(*a); }; });
}

}  // namespace batten::internal
