// SPDX-License-Identifier: MIT
// batten fit curve: points in, a curve and its report out.
#include <memory>

#include "batten/cli/fit_arguments.h"
#include "batten/cli/parse_values.h"
#include "batten/cli/terminal.h"
#include "batten/fitting/fit_curve.h"
#include "batten/io/read_error.h"

namespace batten {
namespace {

struct Arguments : FitArguments {
  Arguments() {
    max_control_points = "2000";
    parameterization = "chord";
  }
  std::string degree = "3", order = "auto", closed = "auto", distance = "auto", corners = "none";
};

// Words of the contract that a later version will understand are told apart from mistakes.
void CheckChoices(const Arguments& a) {
  CheckChoice("--order", a.order, {"auto", "given"}, {"unordered"});
  CheckChoice("--closed", a.closed, {"auto", "no"}, {"yes"});
  CheckChoice("--parameterization",
              a.parameterization,
              {"chord", "centripetal", "uniform", "given"},
              {"foley", "universal"});
  CheckChoice("--distance", a.distance, {"auto", "point", "parameter"}, {"tangent", "squared"});
  CheckChoice("--corners", a.corners, {"none"}, {"auto"});
}

CurveParameterization ToParameterization(const std::string& word) {
  if (word == "given") return CurveParameterization::kGiven;
  if (word == "uniform") return CurveParameterization::kUniform;
  if (word == "centripetal") return CurveParameterization::kCentripetal;
  return CurveParameterization::kChord;
}

CurveDistance ToDistance(const std::string& word) {
  if (word == "parameter") return CurveDistance::kParameter;
  if (word == "point") return CurveDistance::kPoint;
  return CurveDistance::kAuto;
}

CurveFitOptions ToOptions(const Arguments& a) {
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
  options.parameterization = ToParameterization(a.parameterization);
  options.keep_order = a.order == "given";
  options.distance = ToDistance(a.distance);
  options.smoothing = ToSmoothing(a.smoothing);
  options.loss = ToLoss(a.loss);
  options.loss_scale = ToLossScale(a.loss_scale);
  options.optimize = ToFreedom(a.optimize);
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

template <int Dim>
int Fit(const FitFiles& files, const PointCloud& cloud, const CurveFitOptions& options) {
  CurveFit<Dim> fit = files.Explained([&] { return FitCurve<Dim>(cloud, options); });
  return files.Write(
      fit.curve, fit.residuals, fit.parameters.transpose(), fit.outliers, fit.report);
}

int Run(const Arguments& a) {
  CheckChoices(a);
  CurveFitOptions options = ToOptions(a);
  FitFiles files(a);
  const bool given = options.parameterization == CurveParameterization::kGiven;
  const PointCloud& cloud = files.Read(given);
  if (given && cloud.parameters().cols() == 0) {
    files.Refuse("has no column u, which --parameterization given needs (--columns u=1 names one)");
  }
  options.shift = files.shift();
  return cloud.dimension() == 2 ? Fit<2>(files, cloud, options) : Fit<3>(files, cloud, options);
}

}  // namespace

void AddFitCurveCommand(CLI::App& fit, Action& action) {
  auto a = std::make_shared<Arguments>();
  CLI::App& command = *fit.add_subcommand("curve", "Fit a NURBS curve to points along it");
  const auto add = [&](const char* flag, std::string& value, const char* help, const char* type) {
    command.add_option(flag, value, help)->capture_default_str()->type_name(type);
  };
  AddFitArguments(command,
                  *a,
                  {"POINTS",
                   "N",
                   "1e-10",
                   "auto none huber cauchy tukey; auto is none",
                   "Where parameters come from: chord centripetal uniform given; given is a column "
                   "u"});
  add("--degree", a->degree, "Degree of the curve", "P");
  add("--order",
      a->order,
      "auto given; given refuses parameters that do not follow the order of the points",
      "ORDER");
  add("--closed", a->closed, "auto no: the curve is open", "CLOSED");
  add("--distance",
      a->distance,
      "What is fitted: point (the nearest), parameter (at the point's own); auto is parameter with "
      "parameters given",
      "KIND");
  add("--corners", a->corners, "none", "CORNERS");
  command.footer(
      "Examples:\n"
      "  batten fit curve section.xyz -o section.step\n"
      "  batten fit curve outline.csv -o outline.json --tolerance 0.01 --report "
      "outline-report.json\n"
      "  batten fit curve heat.xy -o heat.json --parameterization given --columns u=1,x=1,y=2 "
      "--control-points 9\n"
      "  batten fit curve arc.xy -o arc.step --degree 2 --control-points 3 --optimize "
      "params,weights\n"
      "Where parameters are given and residuals exceed the noise, auto moves the knots.\n"
      "Points are taken in the order of the file. Two columns are a plane curve.\n"
      "Exit code 3 says the best curve is written but the tolerance is not reached.");
  command.callback([a, &action] { action = [a] { return Run(*a); }; });
}

}  // namespace batten
