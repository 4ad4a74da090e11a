// SPDX-License-Identifier: MIT
#include "batten/fitting/interpolate_cloud.h"

#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "batten/fitting/interpolate_curve.h"
#include "batten/fitting/ordered_points.h"
#include "fitting/core/curve_excursion.h"
#include "fitting/core/fit_end.h"
#include "fitting/core/stage_clock.h"
#include "geometry/numeric/number_text.h"

namespace batten {
using namespace internal;
namespace {

constexpr double kMostMiss = 1e-6;   // of the points' size
constexpr double kRounding = 1e-12;  // of the points' size

[[noreturn]] void RefuseCloud(const std::string& reason) { throw std::invalid_argument(reason); }

void Check(const CloudInterpolationOptions& options) {
  if (options.tolerance && !(*options.tolerance > 0 && std::isfinite(*options.tolerance))) {
    RefuseCloud("the tolerance " + NumberText(*options.tolerance) + " is not positive");
  }
  if (options.closed && (options.start_tangent || options.end_tangent)) {
    RefuseCloud("a closed curve has no ends: it takes no start or end tangent");
  }
  if (options.degree == 1 && (options.start_tangent || options.end_tangent)) {
    RefuseCloud(
        "a curve of degree 1 goes straight to the next point: it takes no start or end tangent");
  }
}

// Points that differ from their neighbours, as the curve meets them, with their parameters where
// these are given: as many as points, closed one more.
template <int Dim>
struct Row {
  OrderedPoints ordered;
  Eigen::Matrix<double, Dim, Eigen::Dynamic> points;
  Eigen::VectorXd parameters;
  bool ends_meet = false;  // the last of the ordered points is the first again and left out
};

template <int Dim>
Row<Dim> RowOf(const PointCloud& cloud, const CloudInterpolationOptions& options) {
  const bool given = options.parameterization == CurveParameterization::kGiven;
  Row<Dim> row;
  OrderOptions order;
  order.parameterization = given ? CurveParameterization::kGiven : CurveParameterization::kUniform;
  order.keep_order = options.keep_order;
  row.ordered = OrderPoints(cloud, order);
  row.points = row.ordered.cloud.points().template topRows<Dim>();
  const Eigen::Index count = row.points.cols();
  row.ends_meet = options.closed && count > 1 && row.points.col(0) == row.points.col(count - 1);
  const Eigen::Index points = count - (row.ends_meet ? 1 : 0);
  if (given) {
    const Eigen::VectorXd& u = row.ordered.parameters;
    for (Eigen::Index k = 1; k < count; ++k) {
      if (u[k] > u[k - 1]) continue;
      RefuseCloud("two different points have the parameter u = " + NumberText(u[k]) +
                  ": no curve goes through both there");
    }
    row.parameters.resize(points + (options.closed ? 1 : 0));
    row.parameters.head(points) = u.head(points);
    if (row.ends_meet) {
      row.parameters[points] = u[points];
    } else if (options.closed) {
      double length = 0;
      for (Eigen::Index k = 1; k < count; ++k) {
        length += (row.points.col(k) - row.points.col(k - 1)).stableNorm();
      }
      const double back = (row.points.col(count - 1) - row.points.col(0)).stableNorm();
      row.parameters[points] = u[count - 1] + (u[count - 1] - u[0]) * (back / length);
    }
  }
  row.points.conservativeResize(Dim, points);
  return row;
}

template <int Dim>
InterpolatedCurve<Dim> Interpolated(const Row<Dim>& row, const CloudInterpolationOptions& options) {
  CurveInterpolationOptions how;
  how.degree = options.degree;
  how.parameterization = options.parameterization;
  how.parameters = row.parameters;
  how.closed = options.closed;
  std::vector<PointDerivative<Dim>> derivatives;
  if ((options.start_tangent || options.end_tangent) && row.points.cols() >= 2) {
    const Eigen::VectorXd at =
        options.parameterization == CurveParameterization::kGiven
            ? row.parameters
            : CurveParameters(row.points, options.parameterization, options.degree);
    const auto add = [&](InterpolationEnd end, const std::optional<Eigen::Vector3d>& direction) {
      if (!direction) return;
      derivatives.push_back(EndTangent<Dim>(row.points, at, end, direction->head<Dim>()));
    };
    add(InterpolationEnd::kStart, options.start_tangent);
    add(InterpolationEnd::kEnd, options.end_tangent);
  }
  return InterpolateCurve<Dim>(row.points, how, derivatives);
}

// Throws where the curve misses its points: parameter steps that differ by many orders of magnitude
// leave the solution no digits.
template <int Dim>
void RequireMet(const InterpolatedCurve<Dim>& local, const Row<Dim>& row) {
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

InputSummary Describe(const PointCloud& cloud, const OrderedPoints& ordered) {
  InputSummary input;
  input.points = input.used = cloud.size();
  input.duplicates = ordered.repeats;
  input.spacing = ordered.spacing;
  input.noise = 0;  // there is none to a curve through every point
  input.origin = cloud.origin();
  input.box_min = cloud.origin() + cloud.points().rowwise().minCoeff();
  input.box_max = cloud.origin() + cloud.points().rowwise().maxCoeff();
  return input;
}

}  // namespace

template <int Dim>
CurveFit<Dim> InterpolateCloud(const PointCloud& cloud, const CloudInterpolationOptions& options) {
  Check(options);
  StageClock clock;
  const Row<Dim> row = RowOf<Dim>(cloud, options);
  FitReport report;
  report.input = Describe(cloud, row.ordered);
  clock.Enter(&StageSeconds::solve);
  const InterpolatedCurve<Dim> local = Interpolated<Dim>(row, options);
  RequireMet(local, row);
  clock.Enter(&StageSeconds::project);
  // Errors are measured on the curve that is returned.
  const Eigen::Matrix<double, Dim, 1> move = (cloud.origin() - options.shift).template head<Dim>();
  CurveFit<Dim> fit{
      NurbsCurve<Dim>(local.curve.basis(), local.curve.control_points().colwise() + move),
      Eigen::VectorXd(cloud.size()),
      Eigen::VectorXd(cloud.size()),
      PointMask::Constant(cloud.size(), false),
      {}};
  for (Eigen::Index k = 0; k < cloud.size(); ++k) {
    const Eigen::Index place = row.ordered.place[static_cast<size_t>(k)];
    const double u = local.parameters[place < row.points.cols() ? place : 0];
    const Eigen::Matrix<double, Dim, 1> point = cloud.points().col(k).template head<Dim>() + move;
    fit.parameters[k] = u;
    fit.residuals[k] = (fit.curve.At(u) - point).norm();
  }
  report.error = report.error_all = Summarise(fit.residuals, options.tolerance);
  report.geometry.kind = "curve";
  report.geometry.base = Name(options.parameterization);
  report.geometry.degree = {options.degree};
  report.geometry.control_points = {fit.curve.basis().size()};
  report.geometry.closed = {options.closed};
  report.optimize.why = "interpolation leaves nothing free";
  EnterExcursion<Dim>(local.curve,
                      {row.points.rowwise().minCoeff(), row.points.rowwise().maxCoeff()},
                      cloud.origin(),
                      report);
  JudgeEnd({.rounding = kRounding * (report.input.box_max - report.input.box_min).norm()}, report);
  WarnOfExcursion(report);
  report.seconds = clock.Seconds();
  fit.report = std::move(report);
  return fit;
}

template CurveFit<2> InterpolateCloud<2>(const PointCloud&, const CloudInterpolationOptions&);
template CurveFit<3> InterpolateCloud<3>(const PointCloud&, const CloudInterpolationOptions&);

}  // namespace batten
