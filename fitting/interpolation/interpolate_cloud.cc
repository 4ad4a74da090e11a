// SPDX-License-Identifier: MIT
#include "batten/fitting/interpolate_cloud.h"

#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "batten/fitting/cubic_spline.h"
#include "batten/fitting/interpolate_curve.h"
#include "fitting/core/stage_clock.h"
#include "fitting/interpolation/met_points.h"
#include "geometry/numeric/number_text.h"

namespace batten {
using namespace internal;
namespace {

constexpr double kMostMiss = 1e-6;  // of the points' size

[[noreturn]] void RefuseCloud(const std::string& reason) { throw std::invalid_argument(reason); }

void Check(const CloudInterpolationOptions& options) {
  if (options.tolerance && !(*options.tolerance > 0 && std::isfinite(*options.tolerance))) {
    RefuseCloud("the tolerance " + NumberText(*options.tolerance) + " is not positive");
  }
  if (options.closed && (options.start_tangent || options.end_tangent)) {
    RefuseCloud("a closed curve has no ends: it takes no start or end tangent");
  }
  const bool curvatures = options.start_curvature || options.end_curvature;
  if (options.closed && curvatures)
    RefuseCloud("a closed curve has no ends: it takes no start or end curvature");
  if (curvatures && !options.spline)
    RefuseCloud("curvatures are given at the ends of a cubic spline: choose one");
  if ((options.start_curvature && options.start_tangent) ||
      (options.end_curvature && options.end_tangent))
    RefuseCloud("an end takes a tangent or a curvature, not both");
  if (options.spline && options.degree != 3)
    RefuseCloud("a cubic spline has degree 3, not " + std::to_string(options.degree));
  const bool periodic = options.spline == SplineEnds::kPeriodic;
  if (options.function_of_x && periodic &&
      (options.start_tangent || options.end_tangent || curvatures))
    RefuseCloud(
        "a periodic function goes on at its ends: it takes no tangents or curvatures there");
  if (options.spline && !options.function_of_x && periodic != options.closed) {
    RefuseCloud(options.closed ? "a closed spline is periodic: it has no other ends"
                               : "a periodic spline is closed");
  }
  if (options.function_of_x && options.closed)
    RefuseCloud("a function of x does not come back: it is not closed, but may be periodic");
  if (options.degree == 1 && (options.start_tangent || options.end_tangent)) {
    RefuseCloud(
        "a curve of degree 1 goes straight to the next point: it takes no start or end tangent");
  }
}

bool Given(const CloudInterpolationOptions& options) {
  return options.function_of_x || options.parameterization == CurveParameterization::kGiven;
}

// Parameters of the points, closed one more.
template <int Dim>
Eigen::VectorXd ParametersOf(const MetPoints<Dim>& met, const CloudInterpolationOptions& options) {
  if (Given(options)) return met.parameters;
  return CurveParameters(met.points, options.parameterization, options.degree, options.closed);
}

// The derivative in a direction: of functions with x' = 1, else as fast as the points step there.
template <int Dim>
PointDerivative<Dim> TangentAt(const MetPoints<Dim>& met,
                               const Eigen::VectorXd& parameters,
                               InterpolationEnd end,
                               const Eigen::Vector3d& direction,
                               bool function_of_x) {
  PointDerivative<Dim> derivative =
      EndTangent<Dim>(met.points, parameters, end, direction.head<Dim>());
  if (!function_of_x) return derivative;
  if (!(direction.x() > 0))
    RefuseCloud("a function of x has no tangent (" + RoundedText(direction.x()) + ", " +
                RoundedText(direction.y()) + "): x must increase");
  derivative.value = direction.head<Dim>() / direction.x();
  return derivative;
}

template <int Dim>
CubicEndCondition<Dim> ConditionOf(const MetPoints<Dim>& met,
                                   const Eigen::VectorXd& parameters,
                                   InterpolationEnd end,
                                   const CloudInterpolationOptions& options) {
  const bool start = end == InterpolationEnd::kStart;
  const auto& tangent = start ? options.start_tangent : options.end_tangent;
  const auto& curvature = start ? options.start_curvature : options.end_curvature;
  if (tangent) {
    return {CubicEnd::kFirstDerivative,
            TangentAt<Dim>(met, parameters, end, *tangent, options.function_of_x).value};
  }
  if (curvature) {
    CubicEndCondition<Dim> condition;
    condition.kind = options.function_of_x ? CubicEnd::kFunctionCurvature : CubicEnd::kCurvature;
    if (curvature->size() != (Dim == 2 ? 1 : 3)) {
      RefuseCloud(Dim == 2 ? "the curvature of a plane curve is one number"
                           : "the curvature of a curve in space is a vector of three numbers");
    }
    condition.value.head(curvature->size()) = *curvature;
    return condition;
  }
  const std::string name = start ? "start" : "end";
  if (options.spline == SplineEnds::kClamped)
    RefuseCloud("a clamped spline needs the " + name + " tangent");
  if (options.spline == SplineEnds::kCurvature)
    RefuseCloud("a spline of given curvatures needs the " + name + " curvature, or its tangent");
  return {options.spline == SplineEnds::kNatural ? CubicEnd::kNatural : CubicEnd::kNotAKnot};
}

template <int Dim>
InterpolatedCurve<Dim> SplineThrough(const MetPoints<Dim>& met,
                                     const CloudInterpolationOptions& options) {
  const Eigen::VectorXd t = ParametersOf(met, options);
  if (options.function_of_x && options.spline == SplineEnds::kPeriodic)
    return {PeriodicFunctionCurve<Dim>(met.points, t), t};
  if (options.closed)
    return {ClosedCubicSplineCurve<Dim>(met.points, t), t.head(met.points.cols())};
  const CubicEndCondition<Dim> start = ConditionOf(met, t, InterpolationEnd::kStart, options);
  const CubicEndCondition<Dim> end = ConditionOf(met, t, InterpolationEnd::kEnd, options);
  return {CubicSplineCurve<Dim>(met.points, t, start, end), t};
}

template <int Dim>
InterpolatedCurve<Dim> Interpolated(const MetPoints<Dim>& row,
                                    const CloudInterpolationOptions& options) {
  if (options.spline) return SplineThrough<Dim>(row, options);
  CurveInterpolationOptions how;
  how.degree = options.degree;
  how.parameterization = Given(options) ? CurveParameterization::kGiven : options.parameterization;
  how.parameters = row.parameters;
  how.closed = options.closed;
  std::vector<PointDerivative<Dim>> derivatives;
  if ((options.start_tangent || options.end_tangent) && row.points.cols() >= 2) {
    const Eigen::VectorXd at = ParametersOf(row, options);
    const auto add = [&](InterpolationEnd end, const std::optional<Eigen::Vector3d>& direction) {
      if (!direction) return;
      derivatives.push_back(TangentAt<Dim>(row, at, end, *direction, options.function_of_x));
    };
    add(InterpolationEnd::kStart, options.start_tangent);
    add(InterpolationEnd::kEnd, options.end_tangent);
  }
  return InterpolateCurve<Dim>(row.points, how, derivatives);
}

// Throws where the curve misses its points: parameter steps that differ by many orders of magnitude
// leave the solution no digits.
template <int Dim>
void RequireMet(const InterpolatedCurve<Dim>& local, const MetPoints<Dim>& row) {
  const double size =
      (row.points.rowwise().maxCoeff() - row.points.rowwise().minCoeff()).stableNorm();
  for (Eigen::Index k = 0; k < row.points.cols(); ++k) {
    const double miss = (local.curve.At(local.parameters[k]) - row.points.col(k)).stableNorm();
    if (miss <= kMostMiss * size) continue;
    RefuseCloud(
        "rounding keeps the curve off the points: some are far closer to one another than "
        "others; lower the degree " +
        std::to_string(local.curve.basis().degree()) + ", or leave some of them out");
  }
}

// Warns where part of a curvature given in space lies along the curve: nothing can have it.
template <int Dim>
void WarnOfCurvatureAlong(const NurbsCurve<Dim>& curve,
                          const CloudInterpolationOptions& options,
                          FitReport& report) {
  constexpr double kAlong = 1e-6;  // of the curvature
  if (Dim == 2) return;
  for (const bool start : {true, false}) {
    const auto& given = start ? options.start_curvature : options.end_curvature;
    if (!given) continue;
    const double u = start ? curve.basis().lower() : curve.basis().upper();
    const Eigen::VectorXd tangent = curve.JetAt(u).first.normalized();
    const double along = std::abs(tangent.dot(*given));
    if (along <= kAlong * given->norm()) continue;
    report.warnings.push_back(
        "of the curvature given at the " + std::string(start ? "start" : "end") + " " +
        RoundedText(along) + " is along the curve and can't be met; the part across it, " +
        RoundedText((*given - tangent.dot(*given) * tangent).norm()) + ", is");
  }
}

// Warns where the points were put into the order of x.
void WarnOfOrder(const PointCloud& cloud, FitReport& report) {
  const auto x = cloud.points().row(0);
  for (Eigen::Index k = 1; k < x.size(); ++k) {
    if (x[k] >= x[k - 1]) continue;
    report.warnings.push_back("the points do not come in the order of x: from point " +
                              std::to_string(k + 1) + " on they were sorted");
    return;
  }
}

}  // namespace

template <int Dim>
CurveFit<Dim> InterpolateCloud(const PointCloud& cloud, const CloudInterpolationOptions& options) {
  Check(options);
  StageClock clock;
  const MetPoints<Dim> row =
      MetPointsOf<Dim>(options.function_of_x ? ParameterizedByX(cloud) : cloud,
                       Given(options),
                       options.keep_order,
                       options.closed);
  clock.Enter(&StageSeconds::solve);
  const InterpolatedCurve<Dim> local = Interpolated<Dim>(row, options);
  RequireMet(local, row);
  clock.Enter(&StageSeconds::project);
  CurveFit<Dim> fit = FitThroughPoints<Dim>(
      cloud,
      row,
      local,
      {.base = Name(Given(options) ? CurveParameterization::kGiven : options.parameterization),
       .why = "interpolation leaves nothing free",
       .closed = options.closed,
       .tolerance = options.tolerance,
       .shift = options.shift});
  WarnOfCurvatureAlong<Dim>(local.curve, options, fit.report);
  if (options.function_of_x) WarnOfOrder(cloud, fit.report);
  fit.report.seconds = clock.Seconds();
  return fit;
}

template CurveFit<2> InterpolateCloud<2>(const PointCloud&, const CloudInterpolationOptions&);
template CurveFit<3> InterpolateCloud<3>(const PointCloud&, const CloudInterpolationOptions&);

}  // namespace batten
