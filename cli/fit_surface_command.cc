// SPDX-License-Identifier: MIT
// batten fit surface: points in, a surface and its report out.
#include <memory>

#include "batten/cli/cloud_arguments.h"
#include "batten/cli/fit_output.h"
#include "batten/cli/program.h"
#include "batten/cli/terminal.h"
#include "batten/fitting/fit_surface.h"
#include "batten/io/file_format.h"
#include "batten/io/geometry_file.h"
#include "batten/io/read_error.h"

namespace batten {
namespace {

struct Arguments {
  std::vector<std::string> clouds;
  std::string out;
  CloudArguments cloud;
  OutputArguments output;
  CommonFlags flags;
  WorkFlags work;
  double tolerance = 0;
  std::string degree = "3,3", control_points, smoothing = "auto", loss = "auto", loss_scale = "auto";
  std::string optimize = "auto", origin = "keep";
  std::string base = "auto", closed = "auto", parameterization = "auto", trim = "none", normals = "auto";
  int max_control_points = 20000;
  bool keep_outliers = false;
};

[[noreturn]] void NotYet(const std::string& what) { throw UsageError(what + " is not in this version"); }

double Positive(const std::string& flag, const std::string& text, bool zero_allowed) {
  const std::vector<double> numbers = ParseNumbers(flag, text);
  if (numbers.size() != 1 || numbers[0] < 0 || (!zero_allowed && numbers[0] == 0)) {
    throw UsageError(flag + ": '" + text + "' is not a " +
                     (zero_allowed ? "number of 0 or more" : "positive number"));
  }
  return numbers[0];
}

std::optional<Loss> ToLoss(const std::string& word) {
  if (word == "auto") return std::nullopt;
  if (word == "none") return Loss::kNone;
  if (word == "huber") return Loss::kHuber;
  if (word == "cauchy") return Loss::kCauchy;
  if (word == "tukey") return Loss::kTukey;
  throw UsageError("--loss: '" + word + "' is not one of auto none huber cauchy tukey");
}

OptimizeMode ToOptimize(const std::string& words) {
  if (words == "auto") return OptimizeMode::kAuto;
  if (words == "none") return OptimizeMode::kNone;
  if (words == "params") return OptimizeMode::kParams;
  std::string rest = words + ",";
  for (size_t comma; (comma = rest.find(',')) != std::string::npos; rest.erase(0, comma + 1)) {
    const std::string word = rest.substr(0, comma);
    if (word != "params" && word != "weights" && word != "knots") {
      throw UsageError("--optimize: '" + words + "' is not auto, none or params[,weights][,knots]");
    }
  }
  NotYet("--optimize " + words + ": freeing weights or knots");
}

// Words of the contract that a later version will understand are told apart from mistakes.
void CheckChoices(const Arguments& a) {
  const auto choice = [](const std::string& flag, const std::string& value,
                         const std::vector<std::string>& now, const std::vector<std::string>& later) {
    if (std::find(now.begin(), now.end(), value) != now.end()) return;
    if (std::find(later.begin(), later.end(), value) != later.end()) NotYet(flag + " " + value);
    std::string known;
    for (const auto& list : {now, later}) {
      for (const std::string& word : list) known += " " + word;
    }
    throw UsageError(flag + ": '" + value + "' is not one of" + known);
  };
  choice("--base", a.base, {"auto", "plane"}, {"sheet", "revolution", "sphere", "torus"});
  choice("--closed", a.closed, {"auto", "none"}, {"u", "v", "uv"});
  choice("--parameterization", a.parameterization, {"auto"}, {"given"});
  choice("--trim", a.trim, {"none"}, {"auto"});
  choice("--normals", a.normals, {"auto", "none"}, {"file"});
}

SurfaceFitOptions ToOptions(const Arguments& a, bool has_tolerance) {
  SurfaceFitOptions options;
  std::tie(options.degree_u, options.degree_v) = ParsePair("--degree", a.degree);
  if (has_tolerance) {
    if (!(a.tolerance > 0)) throw UsageError("--tolerance must be positive");
    options.tolerance = a.tolerance;
  }
  if (!a.control_points.empty() && a.control_points != "chosen") {
    options.control_points = ParsePair("--control-points", a.control_points);
  }
  options.max_control_points = a.max_control_points;
  if (a.smoothing != "auto") options.smoothing = Positive("--smoothing", a.smoothing, true);
  options.loss = ToLoss(a.loss);
  if (a.loss_scale != "auto") options.loss_scale = Positive("--loss-scale", a.loss_scale, false);
  options.optimize = ToOptimize(a.optimize);
  options.keep_outliers = a.keep_outliers;
  options.seed = a.work.seed;
  options.threads = a.work.threads;
  options.progress = MakeProgress(a.flags.quiet);
  try {
    Check(options);
  } catch (const std::invalid_argument& error) {
    throw UsageError(error.what());
  }
  return options;
}

// What is subtracted from the coordinates written.
Eigen::Vector3d ToShift(const std::string& origin, const PointCloud& cloud) {
  if (origin == "keep") return Eigen::Vector3d::Zero();
  if (origin == "local") return cloud.origin();
  const std::vector<double> numbers = ParseNumbers("--origin", origin);
  if (numbers.size() != 3) throw UsageError("--origin: '" + origin + "' is not keep, local or x,y,z");
  return {numbers[0], numbers[1], numbers[2]};
}

// 500 m in the data's unit: CAD kernels lose digits beyond.
double FarAway(const std::string& unit) {
  static const std::map<std::string, double> kPerMetre = {
      {"mm", 1000}, {"cm", 100}, {"m", 1}, {"km", 0.001}, {"um", 1e6}, {"inch", 39.3701}, {"in", 39.3701},
      {"ft", 3.28084}, {"foot", 3.28084}};
  const auto found = kPerMetre.find(unit);
  return 500 * (found == kPerMetre.end() ? 1000 : found->second);
}

int Run(const Arguments& a, bool has_tolerance) {
  const auto start = std::chrono::steady_clock::now();
  const auto since = [](std::chrono::steady_clock::time_point t) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - t).count();
  };
  CheckChoices(a);
  CheckOutputArguments(a.output);
  SurfaceFitOptions options = ToOptions(a, has_tolerance);
  // A format word belongs to the file whose kind it names.
  const bool word_is_geometry = a.cloud.format == "json" || a.cloud.format == "step";
  const std::string out_format = word_is_geometry ? a.cloud.format : "";
  const FileFormat format = FormatOf(a.out, out_format);
  if (!IsGeometryFormat(format)) throw UsageError("-o " + a.out + ": a surface is written as .json or .step");
  for (const std::string& path : {a.out, a.output.residuals}) CheckWritable(path);
  for (const std::string& path : a.output.reports) CheckWritable(path);

  CloudReadOptions read = ToReadOptions(a.cloud, a.flags.quiet);
  if (word_is_geometry) read.format.clear();
  const CloudFile file = ReadCloud(a.clouds, read);
  if (file.cloud.dimension() == 2) {
    throw ReadError(a.clouds.front(), "holds points in the plane (two columns); a surface needs x y z");
  }
  const double read_seconds = since(start);

  options.shift = ToShift(a.origin, file.cloud);
  SurfaceFit fit = FitSurface(file.cloud, options);
  FitReport& report = fit.report;
  if (report.termination == Termination::kCancelled) throw Cancelled();
  report.input.files = a.clouds;
  report.input.points = file.points_in_file - file.filtered;
  report.input.non_finite = file.non_finite;
  const double far = file.cloud.World(0).cwiseAbs().maxCoeff();
  if (a.origin == "keep" && far > FarAway(a.output.unit)) {
    report.warnings.push_back("coordinates are more than 500 m from zero, where CAD systems lose digits: "
                              "--origin local writes them near zero and reports the shift");
  }
  const auto write_start = std::chrono::steady_clock::now();
  WriteGeometry({fit.surface}, a.out, {out_format, a.output.unit});
  WriteResiduals(a.output.residuals, file.cloud, fit.residuals, fit.parameters, fit.outliers);
  report.seconds.read = read_seconds;
  report.seconds.write = since(write_start);
  report.seconds.total = since(start);
  WriteReports(report, {a.output, a.flags, a.out, options.shift});
  return report.tolerance_reached().value_or(true) ? kDone : kToleranceMissed;
}

}  // namespace

void AddFitSurfaceCommand(CLI::App& fit, Action& action) {
  auto a = std::make_shared<Arguments>();
  CLI::App& command = *fit.add_subcommand("surface", "Fit a NURBS surface to scattered points");
  command.add_option("CLOUD", a->clouds, "Point files: .pcd .ply .xyz .txt .csv ...; several are one cloud")
      ->required();
  command.add_option("-o,--output", a->out, "Where to write: .step .stp .json")->required()->type_name("OUT");
  CLI::Option* tolerance = command.add_option(
      "--tolerance", a->tolerance, "Orthogonal distance every point must keep; refines where it is missed [none]");
  command.add_option("--degree", a->degree, "Degree in u and v: P or P,Q")->capture_default_str();
  command.add_option("--control-points", a->control_points, "Net of N,M control points [chosen by cross-validation]");
  command.add_option("--max-control-points", a->max_control_points, "Never more control points than this")->capture_default_str();
  command.add_option("--smoothing", a->smoothing, "Fairness relative to the data: auto (1e-4) or a number")->capture_default_str();
  command.add_option("--loss", a->loss, "auto none huber cauchy tukey; auto is robust when outliers are found")->capture_default_str();
  command.add_option("--loss-scale", a->loss_scale, "Standard deviation of good points: auto or a number")->capture_default_str();
  command.add_option("--base", a->base, "Shape the parameters come from: auto plane")->capture_default_str();
  command.add_option("--closed", a->closed, "Closed directions: auto none")->capture_default_str();
  command.add_option("--parameterization", a->parameterization, "auto")->capture_default_str();
  command.add_option("--optimize", a->optimize, "Joint stage by Ceres: auto none params")->capture_default_str();
  command.add_option("--trim", a->trim, "none: the surface is the whole rectangle around the points")->capture_default_str();
  command.add_option("--normals", a->normals, "auto none")->capture_default_str();
  command.add_option("--origin", a->origin, "Subtracted from what is written: keep (nothing), local, or x,y,z")->capture_default_str();
  command.add_flag("--keep-outliers", a->keep_outliers, "Fit every point, however far off");
  AddCloudArguments(command, a->cloud);
  AddOutputArguments(command, a->output);
  AddWorkFlags(command, a->work);
  AddCommonFlags(command, a->flags);
  command.footer(
      "Examples:\n"
      "  batten fit surface scan.ply -o part.step\n"
      "  batten fit surface scan.pcd -o part.step --tolerance 0.05 --report part.json\n"
      "  batten fit surface ground.xyz -o ground.step --where label=1 --tolerance 0.5 --unit m\n"
      "  batten fit surface a.xyz b.xyz -o both.json --degree 5 --control-points 24,16 --residuals off.csv\n"
      "Exit code 3 says the best surface is written but the tolerance is not reached.");
  command.callback([a, tolerance, &action] {
    action = [a, given = tolerance->count() > 0] { return Run(*a, given); };
  });
}

}  // namespace batten
