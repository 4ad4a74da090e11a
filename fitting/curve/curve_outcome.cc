// SPDX-License-Identifier: MIT
#include "fitting/curve/curve_outcome.h"

#include <algorithm>
#include <utility>

#include "batten/fitting/curve_parameterization.h"
#include "fitting/core/box_excursion.h"
#include "fitting/core/fit_end.h"
#include "fitting/core/mask_indices.h"
#include "fitting/core/rounding.h"
#include "fitting/foot_points/curve_distances.h"
#include "geometry/nurbs/placed_curve.h"

namespace batten::internal {
namespace {

constexpr double kStructured = 0.5;  // correlation of neighbouring offsets

// The points of this curve.
PointMask Own(const OrderedPoints& ordered) {
  PointMask own(static_cast<Eigen::Index>(ordered.place.size()));
  for (Eigen::Index k = 0; k < own.size(); ++k) own[k] = ordered.place[static_cast<size_t>(k)] >= 0;
  return own;
}

// Outliers, and the points to which the loss gives zero weight.
PointMask Forgotten(const CurveTask& task,
                    const SolvedCurve& solved,
                    const PointMask& sequence_outliers) {
  const Eigen::VectorXd& weights = solved.problem.data().weights;
  PointMask forgotten = sequence_outliers;
  for (Eigen::Index k = 0; k < forgotten.size() && weights.size() > 0; ++k) {
    const Eigen::Index place = task.ordered.place[static_cast<size_t>(k)];
    if (place >= 0 && weights[place] == 0) forgotten[k] = true;
  }
  return forgotten;
}

// A parameter near the foot point of every point of the curve, NaN for others.
Eigen::VectorXd KnownPlaces(const CurveTask& task, const SolvedCurve& solved) {
  Eigen::VectorXd places(std::ssize(task.ordered.place));
  for (Eigen::Index k = 0; k < places.size(); ++k) {
    const Eigen::Index place = task.ordered.place[static_cast<size_t>(k)];
    places[k] = place < 0 ? kNone : solved.problem.data().parameters(0, place);
  }
  return places;
}

template <int Dim>
NurbsCurve<Dim> Moved(const NurbsCurve<Dim>& curve, const Eigen::Matrix<double, Dim, 1>& move) {
  if (move.isZero(0)) return curve;
  return Translated(curve, move);
}

// Distance of every point from the curve at its own parameter; zero for points of no curve.
template <int Dim>
Eigen::VectorXd OffsetsAtParameters(const OrderedPoints& ordered,
                                    const PointCloud& cloud,
                                    const NurbsCurve<Dim>& curve) {
  Eigen::VectorXd offsets = Eigen::VectorXd::Zero(cloud.size());
  for (Eigen::Index k = 0; k < offsets.size(); ++k) {
    const Eigen::Index place = ordered.place[static_cast<size_t>(k)];
    if (place < 0) continue;
    offsets[k] =
        (curve.At(ordered.parameters[place]) - cloud.points().col(k).template head<Dim>()).norm();
  }
  return offsets;
}

// The correlation of the used points' offsets with those of their neighbours along the curve: 0 for
// noise, towards 1 where the curve misses a shape.
template <int Dim>
double NeighbourCorrelation(const CurveFit<Dim>& fit,
                            const NurbsCurve<Dim>& curve,
                            const PointCloud& cloud) {
  std::vector<Eigen::Index> order = IndicesOf(fit.estimator.used);
  std::stable_sort(order.begin(), order.end(), [&](Eigen::Index a, Eigen::Index b) {
    return fit.parameters[a] < fit.parameters[b];
  });
  using Point = Eigen::Matrix<double, Dim, 1>;
  Point last = Point::Zero();
  double products = 0, squares = 0;
  for (const Eigen::Index k : order) {
    const Point off = cloud.points().col(k).template head<Dim>() - curve.At(fit.parameters[k]);
    products += last.dot(off);
    squares += off.squaredNorm();
    last = off;
  }
  return squares > 0 ? products / squares : 0;
}

template <int Dim>
void Judge(const CurveTask& task,
           const PointCloud& cloud,
           const CurveFit<Dim>& fit,
           const NurbsCurve<Dim>& curve,
           FitReport& report) {
  const PointMask& used = fit.estimator.used;
  EndEvidence evidence;
  evidence.search = report.end.code;
  evidence.control_points_given = task.options.control_points.has_value();
  evidence.noise = task.noise;
  evidence.rounding = kRelativelyEqual * (report.input.box_max - report.input.box_min).norm();
  evidence.structured = NeighbourCorrelation(fit, curve, cloud) > kStructured;
  Eigen::Index farthest = 0;
  used.select(fit.residuals.array().abs(), 0).maxCoeff(&farthest);
  evidence.farthest = cloud.World(farthest);
  JudgeEnd(evidence, report);
}

}  // namespace

template <int Dim>
CurveFit<Dim> MeasuredCurve(const CurveTask& task,
                            const SolvedCurve& solved,
                            const PointCloud& cloud,
                            const PointMask& sequence_outliers,
                            FitReport report) {
  const CurveFitOptions& options = task.options;
  const NurbsCurve<Dim> curve(solved.problem.basis_u(), solved.control_points, solved.weights);
  const Eigen::Matrix<double, Dim, 1> move = (cloud.origin() - options.shift).template head<Dim>();
  NurbsCurve<Dim> written = Moved<Dim>(curve, task.middle + move);
  const NurbsCurve<Dim> measured = Moved<Dim>(written, -move);
  const PointDistances found =
      DistancesNear<Dim>(measured, cloud.points(), KnownPlaces(task, solved), task.pool);
  CurveFit<Dim> fit{std::move(written),
                    found.parameters.row(0).transpose(),
                    found.distances,
                    Forgotten(task, solved, sequence_outliers),
                    {}};
  const PointMask own = Own(task.ordered), used = own && !fit.outliers;
  fit.estimator.used = used;
  report.error = Summarise(fit.residuals, options.tolerance, used);
  report.error_all = used.all()
                         ? report.error
                         : Summarise(fit.residuals, options.tolerance, own || sequence_outliers);
  if (!task.by_feet()) {
    report.parameter_error =
        Summarise(OffsetsAtParameters<Dim>(task.ordered, cloud, measured), options.tolerance, used);
    report.judged_at_parameters = true;
  }
  report.input.used = report.error.points;
  report.input.outliers = fit.outliers.count();
  const int control_points = solved.problem.unknowns();  // that differ
  report.geometry.kind = "curve";
  report.geometry.base = Name(options.parameterization);
  report.geometry.degree = {options.degree};
  report.geometry.control_points = {control_points};
  report.geometry.rational = fit.curve.rational();
  report.geometry.closed = {task.ordered.closed};
  if (control_points > task.ordered.cloud.size()) {
    report.warnings.push_back(
        "there are more control points than points: fairness decides the rest");
  }
  Eigen::AlignedBox<double, Dim> box;
  for (Eigen::Index k = 0; k < used.size(); ++k)
    if (used[k]) box.extend(cloud.points().col(k).template head<Dim>());
  EnterExcursion<Dim>(measured, box, cloud.origin(), report);
  Judge(task, cloud, fit, measured, report);
  WarnOfExcursion(report);
  fit.report = std::move(report);
  return fit;
}

template CurveFit<2> MeasuredCurve<2>(
    const CurveTask&, const SolvedCurve&, const PointCloud&, const PointMask&, FitReport);
template CurveFit<3> MeasuredCurve<3>(
    const CurveTask&, const SolvedCurve&, const PointCloud&, const PointMask&, FitReport);

}  // namespace batten::internal
