// SPDX-License-Identifier: MIT
#include "io/report/report_curve.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "batten/geometry/closure.h"
#include "batten/geometry/curvature.h"
#include "batten/geometry/curve_evaluator.h"
#include "geometry/numeric/dense_solvers.h"
#include "io/exchange/polyline.h"

namespace batten::internal {
namespace {

constexpr double kFlat = 1e-9;  // of the size

// The same for ±v.
Eigen::Vector3d Upward(const Eigen::Vector3d& v) {
  Eigen::Index largest;
  v.cwiseAbs().maxCoeff(&largest);
  return v[largest] < 0 ? Eigen::Vector3d(-v) : v;
}

// Parameters at which one sees how the curve bends. Where direction or curvature jump there are
// two, the first a little before the knot.
std::vector<double> SampleParameters(const NurbsCurve<3>& curve,
                                     const CurveEvaluator<3>& at,
                                     double chord_tolerance) {
  constexpr double kMostPieces = 24, kFewestPieces = 4, kAllPieces = 24000, kBefore = 1e-9,
                   kLargestTurn = 3 * std::numbers::pi / 180;
  const std::vector<double> breaks = KnotBreaks(curve.basis());
  const auto spans = static_cast<double>(breaks.size() - 1);
  const int pieces = static_cast<int>(std::clamp(kAllPieces / spans, kFewestPieces, kMostPieces));
  const std::vector<double> even =
      PolylineParameters([&](double u) { return at.At(u); }, breaks, chord_tolerance, pieces);
  std::vector<double> result;
  const auto direction = [&](double u) { return at.JetAt(u).first.stableNormalized().eval(); };
  std::size_t next = 1;
  for (const double u : even) {
    const bool ends_span = next < breaks.size() && u == breaks[next];
    const double before = ends_span ? u - kBefore * (u - breaks[next - 1]) : u;
    if (!result.empty()) {  // enough between this and the last
      const double last = result.back();
      const double turn = std::acos(std::clamp(direction(last).dot(direction(before)), -1.0, 1.0));
      const int parts = std::clamp(static_cast<int>(std::ceil(turn / kLargestTurn)), 1, 64);
      for (int part = 1; part < parts; ++part) {
        result.push_back(last + (before - last) * (double(part) / parts));
      }
    }
    if (ends_span) {
      ++next;
      const bool jumps = curve.basis().Multiplicity(u) >= curve.basis().degree() - 1;
      if (jumps && before < u && next < breaks.size()) result.push_back(before);
    }
    result.push_back(u);
  }
  return result;
}

// Curvature, and the unit vector away from its centre; none of that where the curve has no
// direction.
struct Bend {
  double curvature = std::numeric_limits<double>::quiet_NaN();
  std::optional<Eigen::Vector3d> away = std::nullopt;
};

Bend BendAt(const NurbsCurve<3>& curve, const CurveJet<3>& jet, double u, const Plan& plan) {
  Bend bend;
  const double speed = jet.first.norm();
  const Eigen::Vector3d across = jet.first.cross(jet.second);
  bend.curvature = across.norm() / (speed * speed * speed);
  if (!std::isfinite(bend.curvature)) {
    const auto limit = CurvatureAt(curve, u);
    bend.curvature = limit ? limit->curvature : std::numeric_limits<double>::quiet_NaN();
  }
  const Eigen::Vector3d tangent = jet.first.stableNormalized();
  if (plan.flat) {
    const Eigen::Vector3d left = plan.normal().cross(tangent);
    const double side = across.dot(plan.normal());
    if (side < 0) bend.curvature = -bend.curvature;
    if (left.norm() > 0) bend.away = (side > 0 ? -left : left).normalized();
    return bend;
  }
  const Eigen::Vector3d inward = jet.second - jet.second.dot(tangent) * tangent;
  if (inward.norm() > kFlat * jet.second.norm() && across.norm() > 0) {
    bend.away = -inward.stableNormalized();
  }
  return bend;
}

}  // namespace

Eigen::Vector3d Plan::normal() const { return u.cross(v); }

Plan PlanOf(const Eigen::Matrix3Xd& places) {
  Plan plan;
  if (places.cols() == 0) return plan;
  const Eigen::Vector3d extents = places.rowwise().maxCoeff() - places.rowwise().minCoeff();
  const double flat = kFlat * extents.norm();
  if (extents.z() <= flat) return plan;
  if (extents.y() <= flat) {
    plan.v = Eigen::Vector3d::UnitZ();
    return plan;
  }
  if (extents.x() <= flat) {
    plan.u = Eigen::Vector3d::UnitY();
    plan.v = Eigen::Vector3d::UnitZ();
    return plan;
  }
  const Eigen::Vector3d mean = places.rowwise().mean();
  const Eigen::Matrix3Xd centred = places.colwise() - mean;
  const SymmetricEigen3 axes = EigenOf3(centred * centred.transpose());
  plan.u = Upward(axes.vectors.col(2));
  plan.v = Upward(axes.vectors.col(1));
  plan.flat = (plan.normal().transpose() * centred).cwiseAbs().maxCoeff() <= flat;
  return plan;
}

Eigen::Matrix3Xd CoarseSamples(const NurbsCurve<3>& curve) {
  constexpr int kSpan = 8;
  const std::vector<double> breaks = KnotBreaks(curve.basis());
  std::vector<double> parameters{breaks.front()};
  for (std::size_t k = 1; k < breaks.size(); ++k) {
    for (int part = 1; part <= kSpan; ++part) {
      parameters.push_back(breaks[k - 1] + (breaks[k] - breaks[k - 1]) * (double(part) / kSpan));
    }
  }
  Eigen::Matrix3Xd points;
  CurveEvaluator<3>(curve).Points(parameters, points);
  return points;
}

ReportCurve DrawCurve(const NurbsCurve<3>& curve, const Plan& plan, double chord_tolerance) {
  const CurveEvaluator<3> at(curve);
  const std::vector<double> parameters = SampleParameters(curve, at, chord_tolerance);
  const auto count = static_cast<Eigen::Index>(parameters.size());
  ReportCurve drawn;
  drawn.closed = Closed(curve);
  drawn.planar = plan.flat;
  drawn.points.resize(3, count);
  drawn.parameters = Eigen::Map<const Eigen::VectorXd>(parameters.data(), count);
  drawn.curvature.resize(count);
  drawn.normals.resize(3, count);
  std::optional<Eigen::Vector3d> away;  // the last one known
  Eigen::Index unknown = 0;             // at the beginning
  for (Eigen::Index k = 0; k < count; ++k) {
    const CurveJet<3> jet = at.JetAt(parameters[static_cast<std::size_t>(k)]);
    const Bend bend = BendAt(curve, jet, parameters[static_cast<std::size_t>(k)], plan);
    drawn.points.col(k) = jet.point;
    drawn.curvature[k] = bend.curvature;
    if (bend.away) {
      if (!away) drawn.normals.leftCols(unknown).colwise() = *bend.away;
      away = bend.away;
    }
    if (away) {
      drawn.normals.col(k) = *away;
    } else {
      ++unknown;
    }
  }
  if (!away) {  // straight, or a point: any direction across
    const Eigen::Vector3d along = (drawn.points.col(count - 1) - drawn.points.col(0));
    drawn.normals.colwise() = along.norm() > 0 ? along.unitOrthogonal() : plan.v;
  }
  drawn.net = curve.control_points();
  const std::vector<double> breaks = KnotBreaks(curve.basis());
  drawn.knots.resize(3, static_cast<Eigen::Index>(breaks.size()) - 2);
  for (std::size_t k = 1; k + 1 < breaks.size(); ++k) {
    drawn.knots.col(static_cast<Eigen::Index>(k) - 1) = at.At(breaks[k]);
  }
  return drawn;
}

}  // namespace batten::internal
