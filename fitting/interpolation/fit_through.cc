// SPDX-License-Identifier: MIT
#include "batten/fitting/fit_through.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include "batten/fitting/constrained_curve.h"
#include "batten/fitting/fit_curve.h"
#include "batten/geometry/foot_point.h"
#include "batten/geometry/insert_knots.h"
#include "batten/geometry/thread_pool.h"
#include "fitting/core/fit_end.h"
#include "fitting/core/rounding.h"
#include "fitting/core/shared_constants.h"
#include "fitting/core/stage_clock.h"
#include "fitting/foot_points/curve_distances.h"
#include "fitting/linear/coefficient_order.h"
#include "geometry/numeric/number_text.h"
#include "geometry/nurbs/placed_curve.h"

namespace batten {
using namespace internal;
namespace {

[[noreturn]] void RefuseThrough(const std::string& reason) { throw std::invalid_argument(reason); }

void CheckPlaces(const std::vector<MetPlace>& places) {
  for (size_t i = 0; i < places.size(); ++i) {
    const std::string name = "place " + std::to_string(i + 1) + " to be met ";
    if (!places[i].point.allFinite()) RefuseThrough(name + "is not finite");
    if (!places[i].direction) continue;
    const double length = places[i].direction->stableNorm();
    if (!(length > 0) || !std::isfinite(length)) RefuseThrough(name + "has no direction");
  }
}

// Where the places are met, of points in coordinates of the cloud.
template <int Dim>
class MeetingParameters {
 public:
  // `curve` is the free fit in these coordinates.
  MeetingParameters(const PointCloud& cloud,
                    const CurveFit<Dim>& free,
                    const NurbsCurve<Dim>& curve)
      : cloud_(cloud), curve_(curve), feet_(curve), given_(free.report.judged_at_parameters) {
    for (Eigen::Index k = 0; k < free.parameters.size(); ++k) {
      if (free.outliers[k]) continue;
      first_ = std::min(first_, free.parameters[k]);
      last_ = std::max(last_, free.parameters[k]);
    }
  }

  double Of(const MetPlace& place, const Eigen::Vector3d& point) const {
    const SplineBasis& basis = curve_.basis();
    if (given_ && place.parameter) return basis.Clamp(*place.parameter);
    for (Eigen::Index k = 0; given_ && k < cloud_.size(); ++k) {
      if (cloud_.points().col(k).template head<Dim>() == point.head<Dim>())
        return basis.Clamp(cloud_.parameters()(0, k));
    }
    const double u = feet_.Nearest(point).u;
    if (given_ || basis.periodic()) return u;
    constexpr double kSame = 1e-6;  // of the domain
    const double near = kSame * (basis.upper() - basis.lower());
    return u <= first_ + near ? basis.lower() : u >= last_ - near ? basis.upper() : u;
  }

 private:
  const PointCloud& cloud_;
  const NurbsCurve<Dim>& curve_;
  CurveFootPoints<Dim> feet_;
  bool given_;
  double first_ = std::numeric_limits<double>::infinity(),
         last_ = -std::numeric_limits<double>::infinity();  // of the points' feet
};

// The conditions of all places where the free fit is to meet them, in coordinates of the cloud,
// increasing.
template <int Dim>
std::vector<CurveCondition> ConditionsAt(const NurbsCurve<Dim>& free,
                                         const std::vector<MetPlace>& places,
                                         const Eigen::Vector3d& origin,
                                         const MeetingParameters<Dim>& parameters) {
  std::vector<CurveCondition> conditions;
  for (const MetPlace& place : places) {
    Eigen::Vector3d point = place.point - origin;
    if (Dim == 2) point.z() = 0;
    const double u = parameters.Of(place, point);
    conditions.push_back({u, 0, point.head<Dim>()});
    if (!place.direction) continue;
    const Eigen::Matrix<double, Dim, 1> along = place.direction->head<Dim>().stableNormalized();
    const Eigen::Matrix<double, Dim, 1> velocity = free.JetAt(u).first;
    double speed = velocity.dot(along);
    if (std::abs(speed) < 0.1 * velocity.norm()) speed = std::copysign(velocity.norm(), speed);
    conditions.push_back({u, 1, speed * along});
  }
  std::stable_sort(conditions.begin(), conditions.end(), [](const auto& a, const auto& b) {
    return std::pair(a.u, a.order) < std::pair(b.u, b.order);
  });
  return conditions;
}

// Where the conditions need a function that the basis has not: Schoenberg and Whitney's condition
// with one function for each, the first that will do. None where it holds.
std::optional<double> LacksFunctionAt(const SplineBasis& basis,
                                      const std::vector<CurveCondition>& conditions) {
  int next = 0;
  for (const CurveCondition& condition : conditions) {
    const int span = basis.Span(condition.u);
    next = std::max(next, span - basis.degree());
    if (next > span) return condition.u;
    ++next;
  }
  return std::nullopt;
}

// The middle of the span that holds u.
double MiddleOfSpan(const SplineBasis& basis, double u) {
  const auto span = static_cast<size_t>(basis.Span(u));
  return basis.knots()[span] + (basis.knots()[span + 1] - basis.knots()[span]) / 2;
}

template <int Dim>
class ThroughFit {
 public:
  ThroughFit(const PointCloud& cloud,
             const std::vector<MetPlace>& places,
             const CurveFitOptions& options,
             CurveFit<Dim> free)
      : options_(options),
        pool_(options.threads),
        cloud_(cloud),
        fit_(std::move(free)),
        curve_(Translated(fit_.curve, (options.shift - cloud.origin()).template head<Dim>())),
        conditions_(ConditionsAt<Dim>(
            curve_, places, cloud.origin(), MeetingParameters<Dim>(cloud, fit_, curve_))),
        at_parameters_(fit_.report.judged_at_parameters) {
    if (curve_.rational())
      RefuseThrough("a rational curve is not fitted through places: leave the weights alone");
    weights_ = cloud.weights().size() > 0 ? cloud.weights() : Eigen::VectorXd::Ones(cloud.size());
    weights_ = fit_.outliers.select(0.0, weights_.array()).matrix();
    WarnOfFarPlaces(places);
  }

  CurveFit<Dim> Fitted() {
    StageClock clock;
    clock.Enter(&StageSeconds::refine);
    MakeRoom();
    EndCode end = options_.tolerance ? EndCode::kToleranceReached : EndCode::kCrossValidated;
    for (Settle(); options_.tolerance && FarthestUsed() > *options_.tolerance; Settle()) {
      if (RefineWhereOut()) continue;
      end = EndCode::kMaxControlPoints;
      break;
    }
    clock.Enter(&StageSeconds::project);
    Finish(end);
    fit_.report.seconds += clock.Seconds();
    return std::move(fit_);
  }

 private:
  void WarnOfFarPlaces(const std::vector<MetPlace>& places) {
    constexpr double kFar = 4;  // of the rms of the free fit
    const CurveFootPoints<Dim> feet(curve_);
    for (size_t i = 0; i < places.size(); ++i) {
      Eigen::Vector3d point = places[i].point - cloud_.origin();
      if (Dim == 2) point.z() = 0;
      const double distance = feet.Nearest(point).distance;
      const double usual = std::max(fit_.report.error.rms, options_.tolerance.value_or(0));
      if (distance <= kFar * usual || distance <= kRelativelyEqual * (1 + SizeOfPoints())) continue;
      fit_.report.warnings.push_back("place " + std::to_string(i + 1) + " to be met is " +
                                     RoundedText(distance) + " from the fit without it");
    }
  }

  double SizeOfPoints() const {
    return (cloud_.points().rowwise().maxCoeff() - cloud_.points().rowwise().minCoeff())
        .stableNorm();
  }

  // Knots so that the conditions can be met at all.
  void MakeRoom() {
    for (int k = 0; k < kMostIterations; ++k) {
      const auto u = LacksFunctionAt(curve_.basis(), conditions_);
      if (!u) return;
      curve_ = InsertKnot(curve_, MiddleOfSpan(curve_.basis(), *u));
    }
  }

  // Solves, moves the points to their feet, and again while distances fall.
  void Settle() {
    constexpr int kRounds = 20;
    constexpr double kWorthwhile = 1e-3;
    double last = std::numeric_limits<double>::infinity();
    Measure();
    for (int round = 0; round < kRounds; ++round) {
      curve_ = NurbsCurve<Dim>(curve_.basis(),
                               ConstrainedLeastSquares(curve_.basis(),
                                                       parameters_,
                                                       cloud_.points().template topRows<Dim>(),
                                                       weights_,
                                                       conditions_));
      Measure();
      const double sum = (weights_.array() * distances_.array().square()).sum();
      if (!(sum < (1 - kWorthwhile) * last)) break;
      last = sum;
    }
  }

  void Measure() {
    if (at_parameters_) return MeasureAtParameters();
    const Eigen::VectorXd known =
        parameters_.size() > 0 ? parameters_ : Eigen::VectorXd::Constant(cloud_.size(), kNone);
    PointDistances found = DistancesNear<Dim>(curve_, cloud_.points(), known, pool_);
    parameters_ = found.parameters.row(0).transpose();
    distances_ = std::move(found.distances);
  }

  void MeasureAtParameters() {
    parameters_ = cloud_.parameters().row(0).transpose();
    distances_.resize(cloud_.size());
    for (Eigen::Index k = 0; k < cloud_.size(); ++k) {
      distances_[k] =
          (curve_.At(parameters_[k]) - cloud_.points().col(k).template head<Dim>()).norm();
    }
  }

  double FarthestUsed() const { return fit_.outliers.select(0.0, distances_.array()).maxCoeff(); }

  // Halves the spans with points out of tolerance that hold more than one; whether there is one.
  bool RefineWhereOut() {
    const SplineBasis& basis = curve_.basis();
    std::vector<int> points(basis.knots().size(), 0);
    std::vector<bool> out(points.size(), false);
    for (Eigen::Index k = 0; k < cloud_.size(); ++k) {
      if (fit_.outliers[k]) continue;
      const auto span = static_cast<size_t>(basis.Span(parameters_[k]));
      ++points[span];
      out[span] = out[span] || distances_[k] > *options_.tolerance;
    }
    std::vector<double> knots;
    for (size_t span = 0; span < out.size(); ++span) {
      if (out[span] && points[span] > 1) knots.push_back(MiddleOfSpan(basis, basis.knots()[span]));
    }
    if (knots.empty() || basis.size() + std::ssize(knots) > options_.max_control_points)
      return false;
    curve_ = RefineKnots(curve_, knots);
    return true;
  }

  void Finish(EndCode search) {
    fit_.curve = Translated(curve_, (cloud_.origin() - options_.shift).template head<Dim>());
    FitReport& report = fit_.report;
    report.parameter_error.reset();
    if (at_parameters_) {
      report.parameter_error = Summarise(distances_, options_.tolerance, !fit_.outliers);
      PointDistances feet = DistancesNear<Dim>(curve_, cloud_.points(), parameters_, pool_);
      parameters_ = feet.parameters.row(0).transpose();
      distances_ = std::move(feet.distances);
    }
    fit_.parameters = parameters_;
    fit_.residuals = distances_;
    report.error = Summarise(distances_, options_.tolerance, !fit_.outliers);
    report.error_all = Summarise(distances_, options_.tolerance);
    const SplineBasis& basis = curve_.basis();
    report.geometry.control_points = {DistinctCount(basis)};
    report.optimize = {};
    report.optimize.why = "a curve through given places has no joint stage";
    EndEvidence evidence;
    evidence.search = search;
    evidence.control_points_given = options_.control_points.has_value();
    evidence.noise = report.input.noise;
    evidence.rounding = kRelativelyEqual * SizeOfPoints();
    JudgeEnd(evidence, report);
  }

  const CurveFitOptions& options_;
  ThreadPool pool_;
  const PointCloud& cloud_;
  CurveFit<Dim> fit_;
  NurbsCurve<Dim> curve_;  // in the cloud's coordinates
  std::vector<CurveCondition> conditions_;
  bool at_parameters_;  // points stay at the parameters they came with
  Eigen::VectorXd weights_, parameters_, distances_;
};

}  // namespace

template <int Dim>
CurveFit<Dim> FitCurveThrough(const PointCloud& cloud,
                              const std::vector<MetPlace>& places,
                              const CurveFitOptions& options) {
  CheckPlaces(places);
  CurveFitOptions free = options;
  free.optimize = FreeVariables();
  free.terms = nullptr;
  CurveFit<Dim> fit = FitCurve<Dim>(cloud, free);
  if (places.empty()) return fit;
  return ThroughFit<Dim>(cloud, places, free, std::move(fit)).Fitted();
}

template CurveFit<2> FitCurveThrough<2>(const PointCloud&,
                                        const std::vector<MetPlace>&,
                                        const CurveFitOptions&);
template CurveFit<3> FitCurveThrough<3>(const PointCloud&,
                                        const std::vector<MetPlace>&,
                                        const CurveFitOptions&);

}  // namespace batten
