// SPDX-License-Identifier: MIT
// batten fit surface: points in, a surface and its report out.
#include <memory>

#include "batten/cli/cloud_arguments.h"
#include "batten/cli/fit_output.h"
#include "batten/cli/parse_values.h"
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
  std::optional<double> tolerance;
  std::string out_format;
  std::string degree = "3,3", control_points = "chosen", smoothing = "auto", loss = "auto",
              loss_scale = "auto";
  std::string optimize = "auto", origin = "keep";
  std::string base = "auto", closed = "auto", parameterization = "auto", trim = "none",
              normals = "auto";
  std::string max_control_points = "20000";
  bool keep_outliers = false;
};

[[noreturn]] void NotYet(const std::string& what) {
  throw UsageError(what + " is not in this version");
}

std::optional<Loss> ToLoss(const std::string& word) {
  if (word == "auto") return std::nullopt;
  if (word == "none") return Loss::kNone;
  if (word == "huber") return Loss::kHuber;
  if (word == "cauchy") return Loss::kCauchy;
  return Loss::kTukey;
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
  CheckChoice("--loss", a.loss, {"auto", "none", "huber", "cauchy", "tukey"});
  CheckChoice("--base", a.base, {"auto", "plane"}, {"sheet", "revolution", "sphere", "torus"});
  CheckChoice("--closed", a.closed, {"auto", "none"}, {"u", "v", "uv"});
  CheckChoice("--parameterization", a.parameterization, {"auto"}, {"given"});
  CheckChoice("--trim", a.trim, {"none"}, {"auto"});
  CheckChoice("--normals", a.normals, {"auto", "none"}, {"file"});
}

double ToSmoothing(const std::string& text) {
  constexpr double kMost = 1e12;  // beyond, the points drown in rounding
  const double smoothing = ParseNumber("--smoothing", text, Sign::kNotNegative);
  if (smoothing > kMost) throw UsageError("--smoothing: '" + text + "' is more than 1e12");
  return smoothing;
}

SurfaceFitOptions ToOptions(const Arguments& a) {
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
  if (a.smoothing != "auto") options.smoothing = ToSmoothing(a.smoothing);
  options.loss = ToLoss(a.loss);
  if (a.loss_scale != "auto")
    options.loss_scale = ParseNumber("--loss-scale", a.loss_scale, Sign::kPositive);
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

// What is subtracted from the coordinates written; none says the cloud's own origin.
std::optional<Eigen::Vector3d> ToShift(const std::string& origin) {
  if (origin == "keep") return Eigen::Vector3d::Zero();
  if (origin == "local") return std::nullopt;
  if (origin.find_first_of("0123456789") == std::string::npos) {
    CheckChoice("--origin", origin, {"keep", "local", "x,y,z"});
  }
  const std::vector<double> numbers = ParseNumbers("--origin", origin);
  if (numbers.size() != 3)
    throw UsageError("--origin: '" + origin + "' is not keep, local or x,y,z");
  return Eigen::Vector3d(numbers[0], numbers[1], numbers[2]);
}

// The library's reason why points can't be fitted, with the name of their file.
SurfaceFit Fit(const PointCloud& cloud,
               const SurfaceFitOptions& options,
               const std::vector<std::string>& files) {
  try {
    return FitSurface(cloud, options);
  } catch (const std::invalid_argument& error) {
    const std::string first = files.front() == "-" ? "standard input" : files.front();
    throw ReadError(first + (files.size() > 1 ? " and others" : ""), error.what());
  }
}

// 500 m in the data's unit: CAD kernels lose digits beyond.
double FarAway(const std::string& unit) {
  static const std::map<std::string, double> kPerMetre = {{"mm", 1000},
                                                          {"cm", 100},
                                                          {"m", 1},
                                                          {"km", 0.001},
                                                          {"um", 1e6},
                                                          {"inch", 39.3701},
                                                          {"in", 39.3701},
                                                          {"ft", 3.28084},
                                                          {"foot", 3.28084}};
  const auto found = kPerMetre.find(unit);
  return 500 * (found == kPerMetre.end() ? 1000 : found->second);
}

int Run(const Arguments& a) {
  const auto start = std::chrono::steady_clock::now();
  const auto since = [](std::chrono::steady_clock::time_point t) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - t).count();
  };
  CheckChoices(a);
  CheckOutputArguments(a.output);
  SurfaceFitOptions options = ToOptions(a);
  const std::optional<Eigen::Vector3d> shift = ToShift(a.origin);
  // A format word belongs to the file whose kind it names.
  const bool word_is_geometry = NamesGeometry(a.cloud.format);
  const std::string out_format =
      a.out_format.empty() && word_is_geometry ? a.cloud.format : a.out_format;
  if (!IsGeometryFormat(FormatOf(a.out, out_format))) {
    throw UsageError("-o " + a.out + ": a surface is written as .json or .step");
  }
  std::vector<std::string> outputs = a.output.reports;
  outputs.insert(outputs.end(), {a.out, a.output.residuals});
  CheckDistinct(outputs, a.flags.json);
  for (const std::string& path : outputs) CheckWritable(path);

  CloudReadOptions read = ToReadOptions(a.cloud, a.flags.quiet);
  if (word_is_geometry) read.format.clear();
  const CloudFile file = ReadCloud(a.clouds, read);
  if (file.cloud.dimension() == 2) {
    throw ReadError(a.clouds.front(),
                    "holds points in the plane (two columns); a surface needs x y z");
  }
  const double read_seconds = since(start);

  options.shift = shift.value_or(file.cloud.origin());
  SurfaceFit fit = Fit(file.cloud, options, a.clouds);
  FitReport& report = fit.report;
  if (report.termination == Termination::kCancelled) throw Cancelled();
  report.input.files = a.clouds;
  report.input.points = file.points_in_file - file.filtered;
  report.input.non_finite = file.non_finite;
  const double far = file.cloud.World(0).cwiseAbs().maxCoeff();
  if (a.origin == "keep" && far > FarAway(a.output.unit)) {
    report.warnings.push_back(
        "coordinates are more than 500 m from zero, where CAD systems lose digits: "
        "--origin local writes them near zero and reports the shift");
  }
  const auto write_start = std::chrono::steady_clock::now();
  const auto residuals =
      WriteResiduals(a.output.residuals, file.cloud, fit.residuals, fit.parameters, fit.outliers);
  WriteGeometry({fit.surface}, a.out, {out_format, a.output.unit});
  if (residuals) residuals->Commit();
  report.seconds.read = read_seconds;
  report.seconds.write = since(write_start);
  report.seconds.total = since(start);
  const std::string line = a.out == "-" ? "" : a.out + ": " + report.OneLine();
  WriteReports(report, {a.output, a.flags, a.out, line, options.shift});
  return report.tolerance_reached().value_or(true) ? kDone : kToleranceMissed;
}

}  // namespace

void AddFitSurfaceCommand(CLI::App& fit, Action& action) {
  auto a = std::make_shared<Arguments>();
  CLI::App& command = *fit.add_subcommand("surface", "Fit a NURBS surface to scattered points");
  command
      .add_option(
          "CLOUD", a->clouds, "Point files: .pcd .ply .xyz .txt .csv ...; several are one cloud")
      ->required();
  command.add_option("-o,--output", a->out, "Where to write: .step .stp .json")
      ->required()
      ->type_name("OUT");
  command
      .add_option_function<std::string>(
          "--tolerance",
          [a](const std::string& text) {
            a->tolerance = ParseNumber("--tolerance", text, Sign::kPositive);
          },
          "Orthogonal distance every point must keep; refines where it is missed [none]")
      ->type_name("T");
  command.add_option("--degree", a->degree, "Degree in u and v: P or P,Q")
      ->capture_default_str()
      ->type_name("P[,Q]");
  command
      .add_option("--control-points",
                  a->control_points,
                  "Net of N,M control points, or chosen by cross-validation")
      ->capture_default_str()
      ->type_name("N,M");
  command
      .add_option(
          "--max-control-points", a->max_control_points, "Never more control points than this")
      ->capture_default_str()
      ->type_name("K");
  command
      .add_option(
          "--smoothing", a->smoothing, "Fairness relative to the data: auto (1e-4) or a number")
      ->capture_default_str()
      ->type_name("L");
  command
      .add_option(
          "--loss", a->loss, "auto none huber cauchy tukey; auto is robust when outliers are found")
      ->capture_default_str()
      ->type_name("LOSS");
  command
      .add_option(
          "--loss-scale", a->loss_scale, "Standard deviation of good points: auto or a number")
      ->capture_default_str()
      ->type_name("S");
  command.add_option("--base", a->base, "Shape the parameters come from: auto plane")
      ->capture_default_str()
      ->type_name("BASE");
  command.add_option("--closed", a->closed, "Closed directions: auto none")
      ->capture_default_str()
      ->type_name("CLOSED");
  command.add_option("--parameterization", a->parameterization, "auto")
      ->capture_default_str()
      ->type_name("FROM");
  command.add_option("--optimize", a->optimize, "Joint stage by Ceres: auto none params")
      ->capture_default_str()
      ->type_name("MODE");
  command
      .add_option("--trim", a->trim, "none: the surface is the whole rectangle around the points")
      ->capture_default_str()
      ->type_name("TRIM");
  command.add_option("--normals", a->normals, "auto none")
      ->capture_default_str()
      ->type_name("FROM");
  command
      .add_option(
          "--origin", a->origin, "Subtracted from what is written: keep (nothing), local, or x,y,z")
      ->capture_default_str()
      ->type_name("ORIGIN");
  command.add_flag("--keep-outliers", a->keep_outliers, "Fit every point, however far off");
  command
      .add_option(
          "--output-format", a->out_format, "Format of OUT where its name does not tell: json step")
      ->type_name("FORMAT");
  AddCloudArguments(command, a->cloud);
  AddOutputArguments(command, a->output);
  AddWorkFlags(command, a->work);
  AddCommonFlags(command, a->flags);
  command.footer(
      "Examples:\n"
      "  batten fit surface scan.ply -o part.step\n"
      "  batten fit surface scan.pcd -o part.step --tolerance 0.05 --report part.json\n"
      "  batten fit surface ground.xyz -o ground.step --where label=1 --tolerance 0.5 --unit m\n"
      "  batten fit surface a.xyz b.xyz -o both.json --degree 5 --control-points 24,16 --residuals "
      "off.csv\n"
      "Exit code 3 says the best surface is written but the tolerance is not reached.");
  command.callback([a, &action] { action = [a] { return Run(*a); }; });
}

}  // namespace batten
