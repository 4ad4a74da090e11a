// SPDX-License-Identifier: MIT
#include "fitting/primitives/surface_primitive.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "batten/fitting/distances.h"
#include "batten/geometry/surface_evaluator.h"
#include "fitting/core/distributions.h"
#include "fitting/core/rounding.h"
#include "fitting/primitives/shape_estimate.h"
#include "fitting/primitives/surface_patch.h"
#include "geometry/numeric/constants.h"

namespace batten::internal {
namespace {

struct PatchArea {
  double operator()(const ExactPlane& s) const {
    return (s.x.upper - s.x.lower) * (s.y.upper - s.y.lower);
  }
  double operator()(const ExactCylinder& s) const {
    return s.radius * s.angles.sweep * (s.height.upper - s.height.lower);
  }
  double operator()(const ExactCone& s) const {
    const double slant =
        std::hypot(s.height.upper - s.height.lower, s.radius_upper - s.radius_lower);
    return (s.radius_lower + s.radius_upper) / 2 * s.angles.sweep * slant;
  }
  double operator()(const ExactSphere& s) const {
    return s.radius * s.radius * s.longitude.sweep *
           (std::sin(s.latitude.upper) - std::sin(s.latitude.lower));
  }
  // Of a spindle, what lies across the axis counts as well.
  double operator()(const ExactTorus& s) const {
    const double from = s.tube.start, to = s.tube.start + s.tube.sweep;
    const auto moment = [&](double angle) { return s.major * angle + s.minor * std::sin(angle); };
    if (!(s.minor > s.major)) return s.minor * s.round.sweep * (moment(to) - moment(from));
    const double at_axis = std::acos(-s.major / s.minor);
    double sum = 0, before = from;
    const auto add = [&](double angle) {
      const double next = std::clamp(angle, before, to);
      sum += std::abs(moment(next) - moment(before));
      before = next;
    };
    for (double turn = std::floor(from / kTurn) * kTurn; turn < to + kTurn; turn += kTurn) {
      add(turn - at_axis);
      add(turn + at_axis);
    }
    add(to);
    return s.minor * s.round.sweep * sum;
  }
};

// The place where the parameters of a plane or cylinder are measured.
Eigen::Vector3d Beside(const Eigen::Vector3d& middle, const SurfaceShape& shape) {
  if (const auto* plane = std::get_if<PlaneShape>(&shape)) {
    return middle - (middle - plane->point).dot(plane->normal) * plane->normal;
  }
  const CylinderShape& cylinder = std::get<CylinderShape>(shape);
  return cylinder.point + (middle - cylinder.point).dot(cylinder.axis) * cylinder.axis;
}

// The number of outliers on the other nappe of a cone.
Eigen::Index BeyondApex(const ShapeFit& fit, const Eigen::Matrix3Xd& points) {
  const ConeShape* cone = std::get_if<ConeShape>(&fit.shape);
  if (cone == nullptr || !fit.outliers.any()) return 0;
  constexpr double kNear = 5;
  const double sine = std::sin(cone->half_angle), cosine = std::cos(cone->half_angle);
  const double size = (points.rowwise().maxCoeff() - points.rowwise().minCoeff()).maxCoeff();
  const double near = kNear * std::max(fit.sigma, 1e-9 * size);
  Eigen::Index count = 0;
  for (Eigen::Index k = 0; k < points.cols(); ++k) {
    if (!fit.outliers[k]) continue;
    const Eigen::Vector3d from = points.col(k) - cone->apex;
    const double height = from.dot(cone->axis);
    const double off = cosine * from.cross(cone->axis).norm() + sine * height;
    if (height < 0 && std::abs(off) < near) ++count;
  }
  return count;
}

std::vector<std::string> WarningsOn(const ShapeFit& fit,
                                    const Eigen::Matrix3Xd& points,
                                    ShapeEstimate& estimate) {
  std::vector<std::string> warnings;
  if (fit.used <= fit.freedoms) {
    warnings.push_back("no more points than a " + std::string(Name(fit.kind)) +
                       " has freedoms: nothing tells how exact its numbers are");
    estimate.standard_deviations.setConstant(std::numeric_limits<double>::infinity());
    estimate.warnings.clear();
  } else if (fit.used < 2 * fit.freedoms) {
    warnings.push_back("few more points than a " + std::string(Name(fit.kind)) +
                       " has freedoms: they hardly tell how exact its numbers are");
  }
  constexpr Eigen::Index kFew = 10, kShare = 100;
  const Eigen::Index beyond = BeyondApex(fit, points);
  if (beyond >= std::max(kFew, fit.used / kShare)) {
    warnings.push_back("the apex is inside the data: " + std::to_string(beyond) +
                       " points on the other half of the cone do not count");
  }
  constexpr double kMany = 0.1;
  const Eigen::Index out = fit.outliers.count() - beyond;
  if (static_cast<double>(out) > kMany * static_cast<double>(points.cols())) {
    warnings.push_back(std::to_string(out) + " of " + std::to_string(points.cols()) +
                       " points stand farther off the " + Name(fit.kind) +
                       " than noise explains and do not count");
  }
  warnings.insert(warnings.end(), estimate.warnings.begin(), estimate.warnings.end());
  return warnings;
}

// Throws for degenerate points: coplanar points determine no radii, collinear points no plane.
// Lengths in the fitter's unit.
void RefuseFlat(SurfaceKind kind, const StartData& data, double rounding) {
  constexpr double kLeast = 8;
  const Eigen::Matrix3Xd from = data.sample.points.colwise() - data.centroid;
  const auto thickness = [&](int axis) {
    return (data.inertia_axes.col(axis).transpose() * from).cwiseAbs().maxCoeff();
  };
  if (!(thickness(1) > kLeast * rounding)) {
    throw std::invalid_argument(std::string("the points are collinear: they determine no ") +
                                Name(kind));
  }
  if (kind != SurfaceKind::kPlane && !(thickness(2) > kLeast * rounding)) {
    throw std::invalid_argument(std::string("the points are coplanar: they determine no ") +
                                Name(kind));
  }
}

// Measures on the patch as it is written where the exact shape does not tell: points beyond its
// edges are nearest at an edge, and of a shape far larger than the cloud, which the points do not
// determine, control points keep too few digits.
void MeasureOnPatch(const NurbsSurface& surface,
                    const Eigen::Matrix3Xd& points,
                    const Eigen::Vector3d& move,
                    bool beyond_edges,
                    Eigen::Matrix2Xd& feet,
                    Eigen::VectorXd& distances,
                    ThreadPool& pool) {
  const NurbsSurface local(surface.basis_u(),
                           surface.basis_v(),
                           surface.control_points().colwise() - move,
                           surface.weights());
  const double rounding =
      kRelativeRounding * (points.rowwise().maxCoeff() - points.rowwise().minCoeff()).norm() +
      4 * kEpsilon * surface.control_points().cwiseAbs().maxCoeff();
  Eigen::Matrix3Xd places;
  SurfaceEvaluator(local).Points(feet, places, pool);
  const Eigen::VectorXd at_feet = (points - places).colwise().norm();
  std::vector<Eigen::Index> told;
  for (Eigen::Index k = 0; k < feet.cols(); ++k) {
    const Eigen::Vector2d foot = feet.col(k);
    const bool at_edge = foot.minCoeff() <= 0 || foot.maxCoeff() >= 1;
    const bool agrees = std::abs(at_feet[k] - std::abs(distances[k])) <= rounding;
    if ((beyond_edges && at_edge) || !agrees) told.push_back(k);
  }
  if (told.empty()) return;
  const PointDistances found = DistancesTo(local, points(Eigen::all, told), pool);
  for (size_t i = 0; i < told.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    distances[told[i]] = std::copysign(std::abs(found.distances[at]), distances[told[i]]);
    feet.col(told[i]) = found.parameters.col(at);
  }
}

bool AcrossTheAxis(const ExactTorus& torus) {
  return torus.major + torus.minor * std::cos(torus.tube.start + torus.tube.sweep / 2) < 0;
}

std::vector<bool> ClosedWays(const ExactSurface& patch) {
  if (const auto* s = std::get_if<ExactCylinder>(&patch)) return {s->angles.full(), false};
  if (const auto* s = std::get_if<ExactCone>(&patch)) return {s->angles.full(), false};
  if (const auto* s = std::get_if<ExactSphere>(&patch)) return {s->longitude.full(), false};
  if (const auto* s = std::get_if<ExactTorus>(&patch)) return {s->round.full(), s->tube.full()};
  return {false, false};
}

std::vector<bool> PolesOf(const NurbsSurface& surface) {
  const auto one_point = [&](int j) {
    for (int i = 1; i < surface.size_u(); ++i) {
      if (surface.control_point(i, j) != surface.control_point(0, j)) return false;
    }
    return true;
  };
  return {one_point(0), one_point(surface.size_v() - 1)};
}

}  // namespace

bool LooksAlike(const FittedSurface& shape, const ExactSurface& patch) {
  if (shape.kind == SurfaceKind::kPlane)
    return shape.normal.dot(std::get<ExactPlane>(patch).frame.axis()) > 0;
  const auto* torus = std::get_if<ExactTorus>(&patch);
  // Across a spindle's axis S_u is turned round.
  return (shape.NaturalSide() > 0) != (torus != nullptr && AcrossTheAxis(*torus));
}

PrimitiveSummary NumbersOf(const SurfaceShape& shape,
                           const ExactSurface& patch,
                           const Eigen::Vector3d& middle,
                           const Eigen::Vector3d& move) {
  PrimitiveSummary numbers;
  if (std::holds_alternative<PlaneShape>(shape)) {
    numbers.normal = std::get<ExactPlane>(patch).frame.axis();
    numbers.point = Beside(middle, shape) + move;
  } else if (const auto* sphere = std::get_if<SphereShape>(&shape)) {
    numbers.center = sphere->center + move;
    numbers.radius = sphere->radius;
  } else if (const auto* cylinder = std::get_if<CylinderShape>(&shape)) {
    numbers.axis = std::get<ExactCylinder>(patch).frame.axis();
    numbers.point = Beside(middle, shape) + move;
    numbers.radius = cylinder->radius;
  } else if (const auto* cone = std::get_if<ConeShape>(&shape)) {
    numbers.axis = cone->axis;
    numbers.apex = cone->apex + move;
    numbers.half_angle = cone->half_angle;
  } else if (const auto* torus = std::get_if<TorusShape>(&shape)) {
    numbers.axis = std::get<ExactTorus>(patch).frame.axis();
    numbers.center = torus->center + move;
    numbers.major_radius = torus->major_radius;
    numbers.minor_radius = torus->minor_radius;
  }
  return numbers;
}

double AreaOf(const ExactSurface& patch) { return std::visit(PatchArea{}, patch); }

DescribedSurface Described(const ShapeFit& fit,
                           ShapeFitter& fitter,
                           const Eigen::Matrix3Xd& points,
                           const Eigen::Vector3d& move,
                           double rounding,
                           ThreadPool& pool) {
  if (fit.used < fit.freedoms) {
    throw std::invalid_argument("the loss leaves " + std::to_string(fit.used) + " points, and a " +
                                Name(fit.kind) + " needs " + std::to_string(fit.freedoms) +
                                ": its scale is too small");
  }
  RefuseFlat(fit.kind, fitter.starts(), rounding);
  const ExactSurface local = PatchOf(fit.local, fitter.Counting(fit).points, fit.outliers, pool);
  const ExactSurface patch = Placed(local, fitter.unit(), fitter.middle() + move);
  ShapeEstimate estimate = EstimateOf(fit, fitter, rounding, pool);
  const Eigen::Vector3d middle = fitter.middle() + fitter.unit() * fitter.starts().centroid;
  DescribedSurface described{patch, ToNurbs(patch), NumbersOf(fit.shape, patch, middle, move), {}};
  described.warnings = WarningsOn(fit, points, estimate);
  described.summary.kind = Name(fit.kind);
  described.summary.scale = fit.sigma;
  // Three deviations then cover as much as for normal errors, however few the points.
  estimate.standard_deviations *= FewFactor(static_cast<double>(fit.used - fit.freedoms));
  described.summary.accuracy = std::move(estimate);
  return described;
}

PrimitiveFit SurfaceMeasurement(PrimitiveInput& input,
                                ShapeFitter& fitter,
                                const ShapeFit& fit,
                                const std::string& why) {
  const Eigen::Matrix3Xd& points = input.points();
  DescribedSurface described =
      Described(fit, fitter, points, input.move, input.rounding, input.pool);
  FitReport& report = input.report;
  RoundSummary round;
  round.stage = Name(fit.kind);
  round.control_points_u = described.surface.size_u();
  round.control_points_v = described.surface.size_v();
  round.rms = std::sqrt(fit.distances.squaredNorm() / static_cast<double>(points.cols()));
  round.max = fit.distances.cwiseAbs().maxCoeff();
  round.score = fit.sigma;
  round.seconds = input.clock.Seconds().solve;
  input.clock.Enter(&StageSeconds::project);
  report.iterations.push_back(round);
  const ExactSurface local = Placed(described.patch, 1, -input.move);
  Eigen::Matrix2Xd feet = FootPointsOn(local, points, input.pool);
  Eigen::VectorXd distances = fit.distances;
  if (!LooksAlike(fit.local, described.patch)) distances = -distances;
  MeasureOnPatch(
      described.surface, points, input.move, fit.outliers.any(), feet, distances, input.pool);
  report.warnings.insert(
      report.warnings.end(), described.warnings.begin(), described.warnings.end());
  report.input.spacing = std::sqrt(AreaOf(described.patch) / static_cast<double>(fit.used));
  report.geometry.degree = {described.surface.basis_u().degree(),
                            described.surface.basis_v().degree()};
  report.geometry.control_points = {described.surface.size_u(), described.surface.size_v()};
  report.geometry.rational = described.surface.rational();
  report.geometry.closed = ClosedWays(described.patch);
  report.geometry.poles = PolesOf(described.surface);
  PrimitiveSummary& numbers = described.summary;
  numbers.why = why;
  PrimitiveFit result{{}, std::move(described.surface), {}, {}, {}, {}};
  if (fit.kind == SurfaceKind::kPlane) {
    result.shape = PlaneShape{*numbers.point, *numbers.normal};
  } else if (fit.kind == SurfaceKind::kSphere) {
    result.shape = SphereShape{*numbers.center, *numbers.radius};
  } else if (fit.kind == SurfaceKind::kCylinder) {
    result.shape = CylinderShape{*numbers.point, *numbers.axis, *numbers.radius};
  } else if (fit.kind == SurfaceKind::kCone) {
    result.shape = ConeShape{*numbers.apex, *numbers.axis, *numbers.half_angle};
  } else {
    result.shape =
        TorusShape{*numbers.center, *numbers.axis, *numbers.major_radius, *numbers.minor_radius};
  }
  if (input.merged.duplicates == 0) {
    result.parameters = std::move(feet);
    result.residuals = std::move(distances);
    result.outliers = fit.outliers;
  } else {
    result.parameters = feet(Eigen::all, input.merged.place);
    result.residuals = distances(input.merged.place);
    result.outliers = fit.outliers(input.merged.place);
  }
  FinishReport(input, std::move(numbers), "surface", result);
  return result;
}

}  // namespace batten::internal
