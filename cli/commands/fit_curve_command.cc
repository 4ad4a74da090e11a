// SPDX-License-Identifier: MIT
// batten fit curve: points in, a curve and its report out.
#include <fmt/format.h>

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "batten/fitting/fit_curve.h"
#include "batten/fitting/fit_locally.h"
#include "batten/fitting/fit_through.h"
#include "batten/fitting/interpolate_cloud.h"
#include "batten/geometry/arc_length.h"
#include "batten/io/read_error.h"
#include "cli/arguments/fit_arguments.h"
#include "cli/commands/commands.h"
#include "cli/commands/file_kind.h"
#include "cli/terminal/cli11.h"
#include "cli/terminal/offered_words.h"
#include "cli/terminal/parse_values.h"
#include "cli/terminal/terminal.h"
#include "fitting/ordering/curve_closure.h"

namespace batten::internal {
namespace {

struct FitCurveArguments : FitArguments {
  FitCurveArguments() {
    curves = true;
    max_control_points = "2000";
    parameterization = "chord";
  }
  std::string degree = "3", order = "auto", closed = "auto", component = "the only one",
              distance = "auto", corners = "auto", start_tangent, end_tangent, start_curvature,
              end_curvature, spline, method = "global", through, tangents;
  bool interpolate = false;

  bool local() const { return method != "global"; }
  bool constrained() const { return !through.empty() || !tangents.empty(); }
};

using Refusal = std::function<void(const char* flag, bool given)>;

Refusal MeaninglessWith(const std::string& what) {
  return [what](const char* flag, bool given) {
    if (given) throw UsageError(std::string(flag) + " has no meaning with " + what);
  };
}

// What a curve through every point, or piece by piece, leaves no room for.
void CheckInOrder(const FitCurveArguments& a, const Refusal& refuse) {
  refuse("--uncertainty", a.uncertainty || !a.uncertainty_map.empty());
  refuse("--control-points", a.control_points != "chosen");
  refuse("--smoothing", a.smoothing != "auto");
  refuse("--loss", a.loss != "auto" && a.loss != "none");
  refuse("--loss-scale", a.loss_scale != "auto");
  refuse("--optimize", a.optimize != "auto" && a.optimize != "none");
  refuse("--distance", a.distance != "auto");
  refuse("--max-control-points", a.max_control_points != "2000");
  refuse("--component", a.component != "the only one");
  refuse("--order unordered", a.order == "unordered");
  refuse("--through", !a.through.empty());
  refuse("--tangents", !a.tangents.empty());
}

void CheckInterpolation(const FitCurveArguments& a) {
  const Refusal refuse = MeaninglessWith("--interpolate, which goes through every point");
  CheckInOrder(a, refuse);
  refuse("--corners", a.corners != "auto");
  if (a.closed == "yes" && !(a.start_tangent.empty() && a.end_tangent.empty()))
    throw UsageError("--closed yes leaves no ends for --start-tangent and --end-tangent");
  if (a.spline.empty()) return;
  if (a.degree != "3") throw UsageError("--spline is a cubic: --degree " + a.degree + " is not 3");
  if (a.closed == "yes" && a.spline != "periodic")
    throw UsageError("--closed yes is --spline periodic: --spline " + a.spline + " has ends");
  if (a.closed == "no" && a.spline == "periodic" && a.parameterization != "x")
    throw UsageError("--spline periodic closes the curve: --closed no contradicts it");
  const auto lacks = [&](const std::string& tangent, const std::string& curvature) {
    return (a.spline == "clamped" && tangent.empty()) ||
           (a.spline == "curvature" && tangent.empty() && curvature.empty());
  };
  if (lacks(a.start_tangent, a.start_curvature) || lacks(a.end_tangent, a.end_curvature)) {
    throw UsageError(a.spline == "clamped"
                         ? "--spline clamped needs --start-tangent and --end-tangent"
                         : "--spline curvature needs --start-curvature and --end-curvature");
  }
}

void CheckLocal(const FitCurveArguments& a) {
  const Refusal refuse = MeaninglessWith("--method " + a.method + ", which goes piece by piece");
  CheckInOrder(a, refuse);
  refuse("--interpolate", a.interpolate);
  refuse("--degree", a.degree != "3");
  refuse("--parameterization", a.parameterization != "chord");
  if (a.method == "local-parabolic" && a.tolerance) {
    throw UsageError(
        "--method local-parabolic goes through every point: local-conic and local-cubic keep a "
        "--tolerance");
  }
}

// Flags that say two things at once.
void CheckFitCurve(const FitCurveArguments& a) {
  if ((a.uncertainty || !a.uncertainty_map.empty()) && a.component == "all")
    throw UsageError("--uncertainty: is of one curve, not of --component all");
  if (a.order == "given" && a.component != "the only one") {
    throw UsageError(
        "--order given makes the points one curve: --component has no meaning with it");
  }
  if (!a.interpolate) {
    if (!a.start_tangent.empty() || !a.end_tangent.empty()) {
      throw UsageError(
          "--start-tangent and --end-tangent are for --interpolate: an approximation is as the "
          "points are (--tangents holds directions)");
    }
    if (!a.spline.empty()) throw UsageError("--spline is for --interpolate: add it");
  }
  if (a.spline.empty() && !(a.start_curvature.empty() && a.end_curvature.empty()))
    throw UsageError("--start-curvature and --end-curvature are for --interpolate --spline");
  if (a.local()) return CheckLocal(a);
  if (a.interpolate) return CheckInterpolation(a);
  if (!a.constrained()) return;
  const Refusal refuse = MeaninglessWith("--through and --tangents");
  refuse("--uncertainty", a.uncertainty || !a.uncertainty_map.empty());
  refuse("--component", a.component != "the only one");
  refuse("--optimize", a.optimize != "auto" && a.optimize != "none");
}

std::optional<Eigen::Vector3d> ToDirection(const std::string& flag, const std::string& text) {
  if (text.empty()) return std::nullopt;
  const std::vector<double> numbers = ParseNumbers(flag, text);
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();
  if (numbers.size() < 2 || numbers.size() > 3)
    throw UsageError(flag + ": '" + text + "' is not a direction x,y or x,y,z");
  for (size_t k = 0; k < numbers.size(); ++k) direction[static_cast<Eigen::Index>(k)] = numbers[k];
  if (direction.isZero(0)) throw UsageError(flag + ": '" + text + "' has no length");
  return direction;
}

PointOrder ToOrder(const std::string& word) {
  if (word == "given") return PointOrder::kGiven;
  if (word == "unordered") return PointOrder::kUnordered;
  return PointOrder::kAuto;
}

ClosedChoice ToClosed(const std::string& word) {
  if (word == "yes") return ClosedChoice::kYes;
  if (word == "no") return ClosedChoice::kNo;
  return ClosedChoice::kAuto;
}

CurveParameterization ToParameterization(const std::string& word) {
  if (word == "given") return CurveParameterization::kGiven;
  if (word == "uniform") return CurveParameterization::kUniform;
  if (word == "centripetal") return CurveParameterization::kCentripetal;
  if (word == "foley") return CurveParameterization::kFoley;
  if (word == "universal") return CurveParameterization::kUniversal;
  if (word == "x") return CurveParameterization::kGiven;
  return CurveParameterization::kChord;
}

CurveDistance ToDistance(const std::string& word) {
  if (word == "parameter") return CurveDistance::kParameter;
  if (word == "point") return CurveDistance::kPoint;
  if (word == "tangent") return CurveDistance::kTangent;
  if (word == "squared") return CurveDistance::kSquared;
  return CurveDistance::kAuto;
}

// Which of several curves: one by its number, all, or the only one there is.
struct Component {
  bool all = false;
  std::optional<int> number = std::nullopt;
};

Component ToComponent(const std::string& text) {
  if (text == "the only one") return {};
  if (text == "all") return {.all = true};
  constexpr int kMost = 1000000;
  return {.number = static_cast<int>(ParseWhole("--component", text, 1, kMost))};
}

// What several fits of one cloud say together: every point has the distance from the nearest curve.
template <int Dim>
struct JointFit {
  CurveFit<Dim> fit;
  std::vector<int> owners;  // the number of that curve; empty: there is one only
};

template <int Dim>
JointFit<Dim> Together(const std::vector<CurveFit<Dim>>& fits, std::optional<double> tolerance) {
  CurveFit<Dim> joint = fits.front();
  std::vector<int> owners(static_cast<std::size_t>(joint.residuals.size()), 0);
  if (fits.size() == 1) return {std::move(joint), {}};
  FitReport& report = joint.report;
  for (size_t k = 1; k < fits.size(); ++k) {
    const CurveFit<Dim>& fit = fits[k];
    for (Eigen::Index i = 0; i < joint.residuals.size(); ++i) {
      if (fit.residuals[i] >= joint.residuals[i]) continue;
      joint.residuals[i] = fit.residuals[i];
      joint.parameters[i] = fit.parameters[i];
      owners[static_cast<std::size_t>(i)] = static_cast<int>(k);
    }
    joint.outliers = joint.outliers || fit.outliers;
    report.Join(fit.report);
  }
  report.error = Summarise(joint.residuals, tolerance, !joint.outliers);
  report.error_all = Summarise(joint.residuals, tolerance);
  report.input.used = report.error.points;
  report.input.outliers = joint.outliers.count();
  return {std::move(joint), std::move(owners)};
}

// Warns of curves that came out open though their ends are no farther apart than points that follow
// one another: whoever knows that they meet can say so.
template <int Dim>
void SuggestClosing(std::vector<CurveFit<Dim>>& fits) {
  constexpr double kGapInSpacings = 1.5, kFewestSpacings = 6;
  for (size_t k = 0; k < fits.size(); ++k) {
    const NurbsCurve<Dim>& curve = fits[k].curve;
    FitReport& report = fits[k].report;
    const double spacing = report.input.spacing;
    const auto& basis = curve.basis();
    const double gap = (curve.At(basis.upper()) - curve.At(basis.lower())).norm();
    const bool open = !report.geometry.closed.front();
    if (!open || gap > kGapInSpacings * spacing || ArcLength(curve) < kFewestSpacings * spacing)
      continue;
    report.warnings.push_back(
        fmt::format("{}the ends are {:.4g} apart, points {:.4g}: if the curve is to close there, "
                    "--closed yes closes it",
                    fits.size() > 1 ? fmt::format("curve {}: ", k + 1) : "",
                    gap,
                    spacing));
  }
}

CurveFitOptions ToFitCurveOptions(const FitCurveArguments& a) {
  constexpr int kMostControlPoints = 1000000;
  CurveFitOptions options;
  options.degree = static_cast<int>(ParseWhole("--degree", a.degree, 1, kMaxDegree));
  const auto fewest = static_cast<std::uint64_t>(options.degree) + 1;
  options.tolerance = a.tolerance;
  if (a.control_points != "chosen") {
    options.control_points = static_cast<int>(
        ParseWhole("--control-points", a.control_points, fewest, kMostControlPoints));
  }
  options.max_control_points = static_cast<int>(
      ParseWhole("--max-control-points", a.max_control_points, fewest, kMostControlPoints));
  if (options.control_points && a.max_control_points != FitCurveArguments().max_control_points &&
      *options.control_points > options.max_control_points) {
    throw UsageError("--control-points " + a.control_points +
                     " is more than --max-control-points " + a.max_control_points + " allows");
  }
  options.parameterization = ToParameterization(a.parameterization);
  options.order = ToOrder(a.order);
  options.closed = ToClosed(a.closed);
  options.corners = a.corners == "auto";
  options.distance = ToDistance(a.distance);
  options.smoothing = ToSmoothing(a.smoothing);
  options.loss = ToLoss(a.loss);
  options.loss_scale = ToLossScale(a.loss_scale);
  options.optimize = ToFreeVariables(a.optimize);
  return WithWork(std::move(options), a);
}

// A fit in little time, for where time is up before there is any.
CurveFitOptions QuickCurveOptions(CurveFitOptions options) {
  constexpr int kEnough = 100;
  options.optimize = FreeVariables();
  options.max_control_points = std::min(options.max_control_points, kEnough);
  return options;
}

template <int Dim>
int Fit(FitFiles& files,
        const PointCloud& cloud,
        const CurveFitOptions& options,
        const Component& component,
        const std::string& path) {
  const auto fit = [&](const CurveFitOptions& options) {
    if (component.all) return FitCurves<Dim>(cloud, options);
    std::vector<CurveFit<Dim>> one;
    one.push_back(component.number ? FitComponent<Dim>(cloud, *component.number, options)
                                   : FitCurve<Dim>(cloud, options));
    return one;
  };
  std::vector<CurveFit<Dim>> fits = files.Explained([&] {
    try {
      return fit(options);
    } catch (const std::invalid_argument& refusal) {
      throw std::invalid_argument(refusal.what() + OtherCommand(cloud, FileUse::kCurve, path));
    } catch (const Cancelled&) {
      if (!files.TimeIsUp()) throw;
      std::vector<CurveFit<Dim>> quick = fit(QuickCurveOptions(options));
      for (CurveFit<Dim>& one : quick) files.NoteTimeLimit(one.report);
      return quick;
    }
  });
  if (options.closed == ClosedChoice::kAuto &&
      options.parameterization != CurveParameterization::kGiven)
    SuggestClosing(fits);
  if (fits.size() == 1) files.NoteUncertainty(fits.front());
  auto [joint, owners] = Together(fits, options.tolerance);
  std::vector<Geometry> curves;
  for (const CurveFit<Dim>& fit : fits) curves.push_back(fit.curve);
  return files.Write(curves,
                     joint.residuals,
                     joint.parameters.transpose(),
                     joint.outliers,
                     joint.report,
                     std::move(owners));
}

std::optional<SplineEnds> ToSpline(const std::string& word) {
  if (word.empty()) return std::nullopt;
  if (word == "natural") return SplineEnds::kNatural;
  if (word == "clamped") return SplineEnds::kClamped;
  if (word == "curvature") return SplineEnds::kCurvature;
  if (word == "periodic") return SplineEnds::kPeriodic;
  return SplineEnds::kNotAKnot;
}

std::optional<Eigen::VectorXd> ToCurvature(const std::string& flag,
                                           const std::string& text,
                                           int dimension) {
  if (text.empty()) return std::nullopt;
  const std::vector<double> numbers = ParseNumbers(flag, text);
  if (std::ssize(numbers) != (dimension == 2 ? 1 : 3)) {
    throw UsageError(flag + ": '" + text + "' is not " +
                     (dimension == 2 ? "one number, which a plane curve takes: one over the radius"
                                     : "x,y,z, which a curve in space takes: towards the centre"));
  }
  return Eigen::Map<const Eigen::VectorXd>(numbers.data(), std::ssize(numbers));
}

// Warns of a curve that is closed over a gap, as asked for.
void WarnOfGap(const PointCloud& cloud, FitReport& report) {
  const EndGap ends = JudgeEnds(cloud.points(), 0);
  if (ends.closed) return;
  report.warnings.push_back("the ends of the points are " + fmt::format("{:.4g}", ends.gap) +
                            " apart: the curve bridges that gap");
}

// Warns of rows that a curve through every point does not go through.
void WarnOfMissing(const FitFiles& files, FitReport& report) {
  const auto& missing = files.missing();
  if (missing.empty()) return;
  report.warnings.push_back(
      fmt::format("{} of the rows, the first number {}, {} not finite and left out: the curve does "
                  "not go through what they stand for",
                  missing.size(),
                  missing.front() + 1,
                  missing.size() == 1 ? "is" : "are"));
}

template <int Dim>
int WriteFit(const FitFiles& files, CurveFit<Dim> fit) {
  return files.Write(
      {fit.curve}, fit.residuals, fit.parameters.transpose(), fit.outliers, fit.report);
}

template <int Dim>
int FitLocal(const FitFiles& files, const PointCloud& cloud, const FitCurveArguments& a) {
  LocalFitOptions options;
  options.pieces = a.method == "local-parabolic" ? LocalPieces::kParabolas
                   : a.method == "local-conic"   ? LocalPieces::kConics
                                                 : LocalPieces::kCubics;
  options.tolerance = a.tolerance;
  options.closed =
      a.closed == "yes" || (a.closed == "auto" && JudgeEnds(cloud.points(), 0).repeated);
  options.corners = a.corners == "auto";
  options.shift = files.shift();
  CurveFit<Dim> fit = files.Explained([&] { return FitLocally<Dim>(cloud, options); });
  if (a.closed == "yes") WarnOfGap(cloud, fit.report);
  WarnOfMissing(files, fit.report);
  return WriteFit(files, std::move(fit));
}

// Points of the cloud by their numbers from 1, or those of a file.
std::vector<MetPlace> ToThrough(const std::string& text, const PointCloud& cloud) {
  std::vector<MetPlace> places;
  if (text.empty()) return places;
  if (text.find_first_not_of("0123456789,;") == std::string::npos) {
    for (const double number : ParseNumbers("--through", text)) {
      if (number < 1 || number > static_cast<double>(cloud.size())) {
        throw UsageError(
            fmt::format("--through: there is no point {}; they are 1 to {}", number, cloud.size()));
      }
      const auto k = static_cast<Eigen::Index>(number) - 1;
      places.push_back({cloud.World(k)});
      if (cloud.parameters().cols() > 0) places.back().parameter = cloud.parameters()(0, k);
    }
    return places;
  }
  const PointCloud points = ReadCloud({text}).cloud;
  for (Eigen::Index k = 0; k < points.size(); ++k) places.push_back({points.World(k)});
  return places;
}

// Points with directions: as normals, or in the columns behind the coordinates.
std::vector<MetPlace> ToTangents(const std::string& path, int dimension) {
  std::vector<MetPlace> places;
  if (path.empty()) return places;
  CloudReadOptions columns;
  columns.columns = dimension == 2
                        ? std::map<std::string, std::string>{{"x", "1"}, {"y", "2"}}
                        : std::map<std::string, std::string>{{"x", "1"}, {"y", "2"}, {"z", "3"}};
  CloudReadOptions directions;
  directions.columns = dimension == 2
                           ? std::map<std::string, std::string>{{"x", "3"}, {"y", "4"}}
                           : std::map<std::string, std::string>{{"x", "4"}, {"y", "5"}, {"z", "6"}};
  const PointCloud points = ReadCloud({path}, columns).cloud;
  const PointCloud along = ReadCloud({path}, directions).cloud;
  if (points.size() != along.size()) throw ReadError(path, "has points without directions");
  for (Eigen::Index k = 0; k < points.size(); ++k)
    places.push_back({points.World(k), along.World(k)});
  return places;
}

template <int Dim>
int FitThrough(const FitFiles& files,
               const PointCloud& cloud,
               const CurveFitOptions& options,
               const FitCurveArguments& a) {
  std::vector<MetPlace> places = ToThrough(a.through, cloud);
  for (MetPlace& place : ToTangents(a.tangents, Dim)) places.push_back(std::move(place));
  return WriteFit(files,
                  files.Explained([&] { return FitCurveThrough<Dim>(cloud, places, options); }));
}

template <int Dim>
int Interpolate(const FitFiles& files, const PointCloud& cloud, const FitCurveArguments& a) {
  CloudInterpolationOptions options;
  options.degree = static_cast<int>(ParseWhole("--degree", a.degree, 1, kMaxDegree));
  options.parameterization = ToParameterization(a.parameterization);
  options.keep_order = a.order == "given";
  options.start_tangent = ToDirection("--start-tangent", a.start_tangent);
  options.end_tangent = ToDirection("--end-tangent", a.end_tangent);
  options.spline = ToSpline(a.spline);
  options.function_of_x = a.parameterization == "x";
  options.start_curvature = ToCurvature("--start-curvature", a.start_curvature, Dim);
  options.end_curvature = ToCurvature("--end-curvature", a.end_curvature, Dim);
  options.closed =
      a.closed == "yes" || (options.spline == SplineEnds::kPeriodic && !options.function_of_x) ||
      (a.closed == "auto" && !options.spline && !options.start_tangent && !options.end_tangent &&
       options.parameterization != CurveParameterization::kGiven &&
       JudgeEnds(cloud.points(), 0).repeated);
  options.tolerance = a.tolerance;
  options.shift = files.shift();
  CurveFit<Dim> fit = files.Explained([&] { return InterpolateCloud<Dim>(cloud, options); });
  if (options.closed && (a.closed == "yes" || a.spline == "periodic")) WarnOfGap(cloud, fit.report);
  WarnOfMissing(files, fit.report);
  return WriteFit(files, std::move(fit));
}

int RunFitCurve(const FitCurveArguments& a) {
  CheckFitCurve(a);
  CurveFitOptions options = ToFitCurveOptions(a);
  const Component component = ToComponent(a.component);
  std::vector<std::string> beside;
  if (!a.tangents.empty()) beside.push_back(a.tangents);
  FitFiles files(a, beside);
  const bool given = a.parameterization == "given";
  const PointCloud& read = files.Read(given);
  const PointCloud cloud = a.parameterization == "x" ? ParameterizedByX(read) : read;
  if (given && cloud.parameters().cols() == 0) {
    files.Refuse("has no column u, which --parameterization given needs (--columns u=1 names one)");
  }
  options.shift = files.shift();
  if (a.local()) {
    return cloud.dimension() == 2 ? FitLocal<2>(files, cloud, a) : FitLocal<3>(files, cloud, a);
  }
  if (a.constrained()) {
    return cloud.dimension() == 2 ? FitThrough<2>(files, cloud, options, a)
                                  : FitThrough<3>(files, cloud, options, a);
  }
  if (a.interpolate) {
    return cloud.dimension() == 2 ? Interpolate<2>(files, cloud, a)
                                  : Interpolate<3>(files, cloud, a);
  }
  return cloud.dimension() == 2 ? Fit<2>(files, cloud, options, component, a.clouds.front())
                                : Fit<3>(files, cloud, options, component, a.clouds.front());
}

}  // namespace

void AddFitCurveCommand(CLI::App& fit, Action& action) {
  auto a = std::make_shared<FitCurveArguments>();
  CLI::App& command = *fit.add_subcommand("curve", "Fit a NURBS curve to points along it");
  const auto add = [&](const char* flag, std::string& value, const char* help, const char* type) {
    return command.add_option(flag, value, help)->capture_default_str()->type_name(type);
  };
  AddFitArguments(
      command,
      *a,
      {"POINTS",
       "N",
       "1e-10",
       "auto none huber cauchy tukey truncated; auto leaves out points far off their neighbours, "
       "and is "
       "tukey where there are many",
       "Where parameters come from: chord centripetal uniform foley universal given x; given is a "
       "column u, x makes a function y(x)",
       {"chord", "centripetal", "uniform", "foley", "universal", "given", "x"}});
  add("--degree", a->degree, "Degree of the curve", "P");
  command.add_flag("--interpolate", a->interpolate, "Go through every point, in their order");
  const auto direction = [&](const char* flag, std::string& value, const char* help) {
    command.add_option(flag, value, help)->type_name("x,y[,z]");
  };
  direction("--start-tangent", a->start_tangent, "Direction of an interpolating curve's start");
  direction("--end-tangent", a->end_tangent, "Direction of its end");
  Allow(*command
             .add_option("--spline",
                         a->spline,
                         "With --interpolate: a cubic spline with a knot at every point; its ends "
                         "natural clamped (tangents) curvature not-a-knot periodic")
             ->type_name("ENDS"),
        {"natural", "clamped", "curvature", "not-a-knot", "periodic"});
  command
      .add_option("--start-curvature",
                  a->start_curvature,
                  "Curvature of a spline's start: one over the radius, > 0 turning left; in space "
                  "the vector towards the centre")
      ->type_name("K|x,y,z");
  command.add_option("--end-curvature", a->end_curvature, "Curvature of its end")
      ->type_name("K|x,y,z");
  Allow(*add("--method",
             a->method,
             "global (least squares), or piece by piece in the file's order: local-parabolic "
             "local-conic local-cubic, through every point or, but for parabolas, within "
             "--tolerance",
             "METHOD"),
        {"global", "local-parabolic", "local-conic", "local-cubic"});
  command
      .add_option("--through",
                  a->through,
                  "Points met exactly: a file of them, or numbers of points of the cloud, from 1")
      ->type_name("FILE|I,J,...");
  command
      .add_option("--tangents",
                  a->tangents,
                  "Points met exactly with a direction: a file with columns x y [z] dx dy [dz]")
      ->type_name("FILE");
  Allow(*add("--order",
             a->order,
             "Order of the points: auto (the file's if it follows a curve), given (the file's), "
             "unordered "
             "(found from where they lie)",
             "ORDER"),
        {"auto", "given", "unordered"});
  Allow(*add("--closed", a->closed, "auto (found), yes (any gap is bridged), no (open)", "CLOSED"),
        {"auto", "yes", "no"});
  Suggest(*add("--component",
               a->component,
               "Which of several separate curves: a number, 1 the longest, or all (one OUT for "
               "them all)",
               "K"),
          {"all"});
  Allow(*add("--distance",
             a->distance,
             "What is fitted: point (the nearest), tangent or squared (the same, by steps that "
             "converge "
             "faster), parameter (at the point's own); auto is point, or parameter with parameters "
             "given",
             "KIND"),
        {"auto", "point", "tangent", "squared", "parameter"});
  Allow(*add("--corners", a->corners, "auto (found and kept), none (a smooth curve)", "CORNERS"),
        {"auto", "none"});
  AddUncertaintyArguments(command, *a);
  GroupFitFlags(command);
  command.footer(
      "Examples:\n"
      "  batten fit curve section.xyz -o section.step\n"
      "  batten fit curve outline.csv -o outline.json --tolerance 0.01 --report "
      "outline-report.json\n"
      "  batten fit curve slice.xy -o slice.step --component all\n"
      "  batten fit curve knots.xyz -o knots.step --interpolate --start-tangent 1,0,0\n"
      "  batten fit curve knots.xy -o knots.json --interpolate --spline natural\n"
      "  batten fit curve table.xy -o table.json --interpolate --parameterization x \\\n"
      "    --spline clamped --start-tangent 1,0 --end-tangent 1,2\n"
      "  batten fit curve trace.xy -o trace.step --method local-cubic --tolerance 0.01\n"
      "  batten fit curve edge.xyz -o edge.step --through 1,200 --tangents ends.csv\n"
      "  batten fit curve ring.xyz -o ring.json --order unordered --closed yes --loss tukey\n"
      "  batten fit curve h.xy -o h.json --parameterization given --columns u=1,x=1,y=2 "
      "--control-points 9\n"
      "  batten fit curve arc.xy -o arc.step --degree 2 --optimize params,weights\n"
      "Points may come in any order; the curve closes where its points do, smoothly or at a "
      "corner.\n"
      "Without a tolerance it has as many control points as the data can tell apart from fewer.\n"
      "Where parameters are given and residuals exceed the noise, auto moves the knots.\n"
      "Two columns are a plane curve.\n"
      "Exit code 3 says the best curve is written but the tolerance is not reached.");
  command.callback([a, &action] { action = [a] { return RunFitCurve(*a); }; });
}

}  // namespace batten::internal
