// SPDX-License-Identifier: MIT
// batten fit surface: points in, a surface and its report out.
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "batten/fitting/fit_surface.h"
#include "batten/fitting/refused_data.h"
#include "batten/io/file_format.h"
#include "batten/io/polygon_reader.h"
#include "batten/io/read_error.h"
#include "cli/arguments/fit_arguments.h"
#include "cli/arguments/fit_grid.h"
#include "cli/arguments/fit_parts.h"
#include "cli/arguments/passed_over.h"
#include "cli/arguments/surface_conditions.h"
#include "cli/commands/commands.h"
#include "cli/terminal/cli11.h"
#include "cli/terminal/offered_words.h"
#include "cli/terminal/parse_values.h"
#include "cli/terminal/shell_words.h"
#include "cli/terminal/terminal.h"

namespace batten::internal {
namespace {

struct FitSurfaceArguments : FitArguments {
  FitSurfaceArguments() {
    max_control_points = "20000";
    parameterization = "auto";
    may_keep_all = true;
  }
  std::string degree = "3,3", base = "auto", closed = "auto", trim = "auto", normals = "auto";
  bool keep_outliers = false, snap = false;
  ConditionArguments conditions;
  std::string grid, grid_method = "auto";
  std::optional<double> thin;
  std::string part = "whole";
  PassArguments passes;
};

// Flags that need all points in memory at once.
void CheckPassedOver(const FitSurfaceArguments& a) {
  CheckPassArguments(a.passes, a);
  if (!a.passes.any()) return;
  const FitSurfaceArguments usual;
  const std::vector<std::pair<const char*, bool>> given = {
      {"--residuals", !a.output.residuals.empty()},
      {"--grid", !a.grid.empty()},
      {"--part", a.part != usual.part},
      {"--thin", a.thin.has_value()},
      {"--snap", a.snap},
      {"--parameterization given", a.parameterization == "given"},
      {"--normals file", a.normals == "file"},
      {"--optimize", a.optimize != usual.optimize && a.optimize != "none"},
      {"--clean statistical", ToCleaning(a.clean).statistical.has_value()},
      {"--boundary, --meet, --symmetric and --domain",
       a.conditions.any() || !a.conditions.domain.empty()}};
  for (const auto& [flag, is_given] : given) {
    if (is_given)
      throw UsageError(std::string(flag) + ": needs all points in memory at once; with " +
                       (a.passes.memory ? "--memory" : "--tiles") + " they are passed over");
  }
}

// Flags that do not go together.
void CheckFitSurface(const FitSurfaceArguments& a) {
  if (a.parameterization == "given" && a.base != "auto") {
    throw UsageError("--base " + a.base + ": given parameters need no base");
  }
  if (a.parameterization == "given" && a.snap) {
    throw UsageError("--snap: over given parameters the surface stays free-form");
  }
  if (a.parameterization == "given" && (a.conditions.any() || !a.conditions.domain.empty())) {
    throw UsageError(
        "--parameterization given: --boundary, --meet, --symmetric and --domain need a base of the "
        "fit's own");
  }
  if (a.grid.empty() && a.grid_method != "auto")
    throw UsageError("--grid-method " + a.grid_method + ": needs --grid N,M");
  if (!a.grid.empty() && a.part != "whole")
    throw UsageError("--grid: its rows and columns are one part (--part " + a.part + ")");
  if (a.sew && a.part != "all")
    throw UsageError("--sew joins the surfaces of several parts: it needs --part all");
  const FileFormat format = a.sew ? FormatOf(a.out, a.out_format) : FileFormat::kStep;
  if (format != FileFormat::kStep && format != FileFormat::kBrep)
    throw UsageError("--sew is of STEP and B-rep: -o " + a.out + " holds no shells");
  if (!a.grid.empty() &&
      (a.base != "auto" || a.snap || a.conditions.any() || !a.conditions.domain.empty() ||
       a.loss != "auto" || a.smoothing != "auto" || a.optimize != "auto" || a.clean != "auto" ||
       a.thin)) {
    throw UsageError(
        "--grid: the points' rows and columns are met as they are; --base, --snap, --loss, "
        "--smoothing, --clean, "
        "--optimize, --thin, --boundary, --meet, --symmetric and --domain are for scattered "
        "points");
  }
  if (a.snap && a.conditions.any()) {
    throw UsageError(
        "--snap: an exact shape meets no conditions (--boundary, --meet, --symmetric)");
  }
  if ((a.uncertainty || !a.uncertainty_map.empty()) && (!a.grid.empty() || a.part != "whole"))
    throw UsageError(
        "--uncertainty: is of one surface over scattered points, not of --grid or --part");
  if (a.parameterization == "given" && a.closed != "auto" && a.closed != "none") {
    throw UsageError("--closed " + a.closed + ": over given parameters a surface stays open");
  }
}

// The value of a word that is among the choices, else that of "auto".
template <typename Choice>
Choice Named(const std::string& word, const std::map<std::string, Choice>& choices) {
  const auto found = choices.find(word);
  return found == choices.end() ? Choice::kAuto : found->second;
}

SurfaceFitOptions ToFitSurfaceOptions(const FitSurfaceArguments& a) {
  SurfaceFitOptions options;
  std::tie(options.degree_u, options.degree_v) = ParsePair("--degree", a.degree, 1, kMaxDegree);
  options.tolerance = a.tolerance;
  constexpr int kMostControlPoints = 1000000;  // in all
  if (a.control_points != "chosen") {
    const auto [n, m] = ParsePair("--control-points", a.control_points, 2, kMostControlPoints);
    if (n <= options.degree_u || m <= options.degree_v) {
      throw UsageError("--control-points: '" + a.control_points + "' must exceed the degree " +
                       std::to_string(options.degree_u) + "," + std::to_string(options.degree_v));
    }
    if (std::int64_t{n} * m > kMostControlPoints) {
      throw UsageError("--control-points: '" + a.control_points +
                       "' is more than a million in all");
    }
    options.control_points = {n, m};
  }
  const int fewest = (options.degree_u + 1) * (options.degree_v + 1);
  options.max_control_points = static_cast<int>(
      ParseWhole("--max-control-points", a.max_control_points, fewest, kMostControlPoints));
  const bool as_usual = a.max_control_points == FitSurfaceArguments().max_control_points;
  if (as_usual && !a.passes.tiles.empty()) options.max_control_points = kMostControlPoints;
  if (options.control_points && !as_usual &&
      options.control_points->first * options.control_points->second > options.max_control_points) {
    throw UsageError("--control-points " + a.control_points +
                     " is more than --max-control-points " + a.max_control_points + " allows");
  }
  options.smoothing = ToSmoothing(a.smoothing);
  options.loss = ToLoss(a.loss);
  options.loss_scale = ToLossScale(a.loss_scale);
  options.optimize = ToFreeVariables(a.optimize);
  options.base = Named<BaseShape>(a.base,
                                  {{"plane", BaseShape::kPlane},
                                   {"sheet", BaseShape::kSheet},
                                   {"revolution", BaseShape::kRevolution},
                                   {"sphere", BaseShape::kSphere},
                                   {"torus", BaseShape::kTorus},
                                   {"wing", BaseShape::kWing}});
  options.closed = Named<Closing>(
      a.closed,
      {{"none", Closing::kNone}, {"u", Closing::kU}, {"v", Closing::kV}, {"uv", Closing::kBoth}});
  options.trim = a.trim == "none" ? Trimming::kNone : Trimming::kAuto;
  TakeConditions(a.conditions, options);
  options.given_parameters = a.parameterization == "given";
  options.side_of_normals = a.normals == "file";
  options.keep_outliers = a.keep_outliers || ToCleaning(a.clean).keep_outliers;
  options.snap = a.snap;
  options.thin = a.thin;
  return WithWork(std::move(options), a);
}

// Fits; where no surface covers the points, the refusal says which commands take bodies.
SurfaceFit FitOrName(const PointCloud& cloud,
                     const SurfaceFitOptions& options,
                     const std::string& path) {
  try {
    return FitSurface(cloud, options);
  } catch (const RefusedData& refusal) {
    if (refusal.remedy() != Remedy::kFitPart) throw;
    const std::string file = ShellWord(path);
    throw RefusedData(refusal.what() + FlagsThatHelp(refusal.remedy()) + "; 'batten fit solid " +
                      file + "' takes points all round a body, 'batten fit parts " + file +
                      "' plane and round faces" +
                      (MayHoldFaces(path) ? ", and 'batten " + file + "' chooses" : ""));
  }
}

int RunFitSurface(const FitSurfaceArguments& a) {
  CheckFitSurface(a);
  CheckPassedOver(a);
  SurfaceFitOptions options = ToFitSurfaceOptions(a);
  FitFiles files(a, a.conditions.Files());
  if (!a.grid.empty())
    return RunGridFit(
        files, ToGridOptions(a.grid, a.grid_method, options), options.given_parameters);
  if (a.passes.any()) return RunPassedOver(files, a, std::move(options), a.passes);
  const PointCloud& cloud = files.Read(options.given_parameters, CloudFaces::kFlat);
  if (cloud.dimension() == 2) {
    files.Refuse(
        "holds points in the plane (two columns); a surface needs x y z, 'batten fit curve' takes "
        "them");
  }
  if (options.given_parameters && cloud.parameters().cols() == 0) {
    files.Refuse(
        "has no columns u and v, which --parameterization given needs (--columns u=4,v=5 names "
        "them)");
  }
  options.shift = files.shift();
  const PartChoice part = ToPartChoice(a.part);
  if (part.asked()) return RunPartsFit(files, cloud, options, part);
  SurfaceFit fit =
      files.ExplainedInTime([&] { return FitOrName(cloud, options, a.clouds.front()); },
                            [&] { return FitSurface(cloud, QuickOptions(options, cloud)); });
  files.NoteUncertainty(fit);
  return files.Write({fit.surface}, fit.residuals, fit.parameters, fit.outliers, fit.report);
}

}  // namespace

void AddFitSurfaceCommand(CLI::App& fit, Action& action) {
  auto a = std::make_shared<FitSurfaceArguments>();
  CLI::App& command = *fit.add_subcommand("surface", "Fit a NURBS surface to scattered points");
  const auto add = [&](const char* flag, std::string& value, const char* help, const char* type) {
    return command.add_option(flag, value, help)->capture_default_str()->type_name(type);
  };
  AddFitArguments(command,
                  *a,
                  {"CLOUD",
                   "N,M",
                   "1e-4",
                   "auto none huber cauchy tukey truncated; auto is robust when outliers are found",
                   "Where parameters come from: auto (the base), given (columns u and v)",
                   {"auto", "given"}});
  add("--degree", a->degree, "Degree in u and v: P or P,Q", "P[,Q]");
  Allow(*add("--base",
             a->base,
             "Shape the parameters come from: auto plane sheet (bent, or a tube, laid out flat) "
             "revolution sphere torus wing (both sides of a thin section with a sharp edge)",
             "BASE"),
        {"auto", "plane", "sheet", "revolution", "sphere", "torus", "wing"});
  Allow(*add("--closed",
             a->closed,
             "Directions that close without a seam: auto none u v uv",
             "CLOSED"),
        {"auto", "none", "u", "v", "uv"});
  Allow(*add("--trim",
             a->trim,
             "auto: cut back to the outlines and the holes of the points, a region for every part; "
             "none: the whole rectangle",
             "TRIM"),
        {"auto", "none"});
  Allow(*add("--normals",
             a->normals,
             "file: the surface's normal looks to the side the points' normals do; auto none",
             "FROM"),
        {"auto", "file", "none"});
  AddConditionArguments(command, a->conditions);
  command
      .add_option("--grid",
                  a->grid,
                  "The points are N rows of M, one row after the other: interpolated, or, with "
                  "--tolerance or --control-points, approximated. Points nan are missing cells")
      ->type_name("N,M");
  Allow(*add("--grid-method", a->grid_method, "auto interpolate local least-squares", "METHOD"),
        {"auto", "interpolate", "local", "least-squares"});
  command
      .add_option_function<std::string>(
          "--thin",
          [a](const std::string& text) { a->thin = ParseNumber("--thin", text, Sign::kPositive); },
          "Fit one point in each cube of side D, the one nearest to the middle of its points; all "
          "are measured")
      ->type_name("D");
  Suggest(
      *add("--part",
           a->part,
           "Which connected part of the cloud: whole (all points, one surface), a number, 1 the "
           "one of most points, or all (a surface each, one OUT for them all)",
           "K"),
      {"whole", "all"});
  AddPassArguments(command, a->passes);
  command
      .add_option_function<std::string>(
          "--sew",
          [a](const std::string& text) { a->sew = ParseNumber("--sew", text, Sign::kPositive); },
          "Of --part all, into STEP and B-rep: surfaces whose edges are within T become shells, "
          "closed ones\nsolids [each by itself]")
      ->type_name("T");
  command.add_flag("--keep-outliers", a->keep_outliers, "Fit every point, however far off");
  command.add_flag(
      "--snap",
      a->snap,
      "Take the plane, sphere, cylinder, cone or torus that explains the points as well");
  AddUncertaintyArguments(command, *a);
  GroupFitFlags(command);
  command.footer(
      "Examples:\n"
      "  batten fit surface scan.ply -o part.step\n"
      "  batten fit surface scan.pcd -o part.step --tolerance 0.05 --report part.html\n"
      "  batten fit surface hull.ply -o hull.step --base sheet --residuals off.ply\n"
      "  batten fit surface bush.ply -o bush.step --snap --report bush.json\n"
      "  batten fit surface vase.ply -o vase.step --base revolution --closed u\n"
      "  batten fit surface ground.xyz -o ground.step --where label=1 --tolerance 0.5 --unit m\n"
      "  batten fit surface a.xyz b.xyz -o both.json --degree 5 --control-points 24,16 --residuals "
      "off.csv\n"
      "  batten fit surface hood.ply -o hood.step --boundary fender.json --boundary edge.json\n"
      "  batten fit surface scan.ply -o part.step --thin 0.5 --tolerance 0.05\n"
      "  batten fit surface tile-*.las -o ground.step --memory 1GB --unit m\n"
      "  batten fit surface tile-*.las -o ground.step --tiles auto --unit m\n"
      "  batten fit surface table.pcd -o objects.step --part all --time-limit 60\n"
      "  batten fit surface scan.ply -o part.json --uncertainty --uncertainty-map sigma.ply\n"
      "  batten fit surface probe.xyz -o plate.step --grid 40,60 --tolerance 0.01\n"
      "  batten fit surface half.xyz -o hull.step --symmetric y\n"
      "  batten fit surface lens.xyz -o lens.step --degree 2 --control-points 3,3 --optimize "
      "params,weights\n"
      "  batten fit surface ridge.xyz -o ridge.step --control-points 12,8 --optimize knots\n"
      "  batten fit surface mapped.txt -o mapped.step --parameterization given --columns u=4,v=5\n"
      "Exit code 3 says the best surface is written but the tolerance is not reached.");
  command.callback([a, &command, &action] {
    a->passes.job = JobOf(command);
    action = [a] { return RunFitSurface(*a); };
  });
}

}  // namespace batten::internal
