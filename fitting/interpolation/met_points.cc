// SPDX-License-Identifier: MIT
#include "fitting/interpolation/met_points.h"

#include <stdexcept>
#include <utility>

#include "batten/geometry/thread_pool.h"
#include "fitting/core/box_excursion.h"
#include "fitting/core/fit_end.h"
#include "fitting/core/input_summary.h"
#include "fitting/core/rounding.h"
#include "fitting/foot_points/curve_distances.h"
#include "geometry/numeric/number_text.h"
#include "geometry/nurbs/placed_curve.h"

namespace batten::internal {
namespace {

// Where the parameter is back at the first point.
template <int Dim>
double ClosingParameter(const MetPoints<Dim>& met) {
  const Eigen::VectorXd& u = met.ordered.parameters;
  const Eigen::Index last = u.size() - 1;
  if (met.ends_meet) return u[last];
  double length = 0;
  for (Eigen::Index k = 1; k <= last; ++k)
    length += (met.points.col(k) - met.points.col(k - 1)).stableNorm();
  const double back = (met.points.col(last) - met.points.col(0)).stableNorm();
  return u[last] + (u[last] - u[0]) * (back / length);
}

}  // namespace

template <int Dim>
MetPoints<Dim> MetPointsOf(const PointCloud& cloud, bool given, bool keep_order, bool closed) {
  MetPoints<Dim> met;
  OrderOptions order;
  order.parameterization = given ? CurveParameterization::kGiven : CurveParameterization::kUniform;
  order.keep_order = keep_order;
  met.ordered = OrderPoints(cloud, order);
  met.points = met.ordered.cloud.points().template topRows<Dim>();
  const Eigen::Index count = met.points.cols();
  met.ends_meet = closed && count > 1 && met.points.col(0) == met.points.col(count - 1);
  const Eigen::Index points = count - (met.ends_meet ? 1 : 0);
  if (given) {
    const Eigen::VectorXd& u = met.ordered.parameters;
    for (Eigen::Index k = 1; k < count; ++k) {
      if (u[k] > u[k - 1]) continue;
      throw std::invalid_argument("two different points have the parameter u = " +
                                  NumberText(u[k]) + ": no curve goes through both there");
    }
    met.parameters.resize(points + (closed ? 1 : 0));
    met.parameters.head(points) = u.head(points);
    if (closed) met.parameters[points] = ClosingParameter(met);
  }
  met.points.conservativeResize(Dim, points);
  return met;
}

template <int Dim>
CurveFit<Dim> FitThroughPoints(const PointCloud& cloud,
                               const MetPoints<Dim>& met,
                               const InterpolatedCurve<Dim>& local,
                               const MetPointsReport& how) {
  const Eigen::Matrix<double, Dim, 1> move = (cloud.origin() - how.shift).template head<Dim>();
  CurveFit<Dim> fit{Translated(local.curve, move),
                    Eigen::VectorXd(cloud.size()),
                    Eigen::VectorXd(cloud.size()),
                    PointMask::Constant(cloud.size(), false),
                    {}};
  for (Eigen::Index k = 0; k < cloud.size(); ++k) {
    const Eigen::Index place = met.ordered.place[static_cast<size_t>(k)];
    const double u = local.parameters[place < met.points.cols() ? place : 0];
    const Eigen::Matrix<double, Dim, 1> point = cloud.points().col(k).template head<Dim>() + move;
    fit.parameters[k] = u;
    fit.residuals[k] = (fit.curve.At(u) - point).norm();
  }
  if (!how.meets_all) {
    ThreadPool pool(0);
    const NurbsCurve<Dim> measured = Translated(fit.curve, -move);
    PointDistances found = DistancesNear<Dim>(measured, cloud.points(), fit.parameters, pool);
    fit.parameters = found.parameters.row(0).transpose();
    fit.residuals = std::move(found.distances);
  }
  FitReport& report = fit.report;
  // There is no noise to a curve through every point.
  report.input = SummariseInput(cloud, met.ordered.repeats, met.ordered.spacing, 0);
  report.input.used = cloud.size();
  report.error = report.error_all = Summarise(fit.residuals, how.tolerance);
  report.geometry.kind = "curve";
  report.geometry.base = how.base;
  report.geometry.degree = {fit.curve.basis().degree()};
  report.geometry.control_points = {fit.curve.basis().size()};
  report.geometry.rational = fit.curve.rational();
  report.geometry.closed = {how.closed};
  report.optimize.why = how.why;
  EnterExcursion<Dim>(local.curve,
                      {met.points.rowwise().minCoeff(), met.points.rowwise().maxCoeff()},
                      cloud.origin(),
                      report);
  JudgeEnd({.rounding = kRelativeRounding * (report.input.box_max - report.input.box_min).norm()},
           report);
  WarnOfExcursion(report);
  return fit;
}

template MetPoints<2> MetPointsOf<2>(const PointCloud&, bool, bool, bool);
template MetPoints<3> MetPointsOf<3>(const PointCloud&, bool, bool, bool);
template CurveFit<2> FitThroughPoints<2>(const PointCloud&,
                                         const MetPoints<2>&,
                                         const InterpolatedCurve<2>&,
                                         const MetPointsReport&);
template CurveFit<3> FitThroughPoints<3>(const PointCloud&,
                                         const MetPoints<3>&,
                                         const InterpolatedCurve<3>&,
                                         const MetPointsReport&);

}  // namespace batten::internal
