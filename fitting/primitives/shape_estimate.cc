// SPDX-License-Identifier: MIT
#include "fitting/primitives/shape_estimate.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>
#include <utility>

#include "batten/fitting/statistics.h"
#include "fitting/core/shared_constants.h"
#include "fitting/primitives/shape_scores.h"
#include "fitting/primitives/steady_across.h"
#include "geometry/numeric/constants.h"

namespace batten::internal {
namespace {

std::vector<std::string> NamesOf(SurfaceKind kind) {
  static const std::array<std::vector<std::string>, kSurfaceKinds.size()> names{{
      {"offset", "normal_x", "normal_y"},
      {"center_x", "center_y", "center_z", "radius"},
      {"axis_x", "axis_y", "point_x", "point_y", "radius"},
      {"axis_x", "axis_y", "apex_x", "apex_y", "apex_z", "half_angle"},
      {"axis_x", "axis_y", "center_x", "center_y", "center_z", "major_radius", "minor_radius"},
  }};
  return names[static_cast<std::size_t>(kind)];
}

// The frame in which the parameters are measured.
struct AxisFrame {
  Eigen::Vector3d x, y;
  Eigen::Vector3d middle;  // of the points, in the fitter's unit
};

// A cone's distance along the axis from beside its point to the apex.
double RiseOf(const FittedSurface& shape) {
  return std::cos(shape.slope) / (std::sin(shape.slope) * shape.axis_curvature);
}

Eigen::VectorXd ValuesOf(const FittedSurface& shape, const AxisFrame& frame) {
  Eigen::VectorXd values(FreedomsOf(shape.kind));
  const Eigen::Vector3d direction = shape.Direction();
  if (shape.kind == SurfaceKind::kPlane) {
    values << (shape.point - frame.middle).dot(direction), direction.dot(frame.x),
        direction.dot(frame.y);
    return values;
  }
  if (shape.kind == SurfaceKind::kSphere) {
    values << shape.Center(), 1 / std::abs(shape.curvature);
    return values;
  }
  values.head<2>() << direction.dot(frame.x), direction.dot(frame.y);
  const Eigen::Vector3d on_axis = shape.OnAxis();
  if (shape.kind == SurfaceKind::kCylinder) {
    const Eigen::Vector3d beside =
        on_axis + (frame.middle - on_axis).dot(direction) * direction - frame.middle;
    values.tail<3>() << beside.dot(frame.x), beside.dot(frame.y),
        1 / std::abs(shape.axis_curvature);
  } else if (shape.kind == SurfaceKind::kCone) {
    values.tail<4>() << on_axis + RiseOf(shape) * direction,
        std::atan2(std::abs(std::sin(shape.slope)), std::abs(std::cos(shape.slope)));
  } else {
    const double radius = 1 / shape.curvature;
    values.tail<5>() << on_axis - radius * std::sin(shape.slope) * direction,
        std::abs(1 / shape.axis_curvature - radius * std::cos(shape.slope)), std::abs(radius);
  }
  return values;
}

double Sign(double value) { return value < 0 ? -1 : 1; }

// The Jacobian of the parameters (rows) by the freedoms of SurfaceDistance (columns).
Eigen::MatrixXd DerivativesOf(const FittedSurface& shape, const AxisFrame& frame) {
  const int freedoms = FreedomsOf(shape.kind);
  Eigen::MatrixXd result(freedoms, freedoms);
  const Eigen::Vector3d outward = shape.Outward(), axis = shape.Axis();
  const double tau = shape.axis_curvature, kappa = shape.curvature;
  const double sine = std::sin(shape.slope), cosine = std::cos(shape.slope);
  for (int i = 0; i < freedoms; ++i) {
    const bool sphere = shape.kind == SurfaceKind::kSphere;
    const Eigen::Vector3d turn = i == 1   ? shape.Across()
                                 : i == 2 ? shape.along
                                 : i == 4 ? shape.normal
                                          : Eigen::Vector3d::Zero().eval();
    const Eigen::Vector3d shift = i == 0 ? shape.normal : Eigen::Vector3d::Zero().eval();
    const double d_kappa = i == 6 || (i == 3 && sphere) ? 1 : 0;
    const double d_tau = i == 3 && !sphere ? 1 : 0, d_slope = i == 5 ? 1 : 0;
    const Eigen::Vector3d d_normal = turn.cross(shape.normal);
    if (shape.kind == SurfaceKind::kPlane) {
      const Eigen::Vector3d from = shape.point - frame.middle;
      result.col(i) << shift.dot(shape.normal) + from.dot(d_normal), d_normal.dot(frame.x),
          d_normal.dot(frame.y);
      continue;
    }
    if (sphere) {
      result.col(i) << shift - d_normal / kappa + shape.normal * d_kappa / (kappa * kappa),
          -Sign(kappa) * d_kappa / (kappa * kappa);
      continue;
    }
    const Eigen::Vector3d d_outward = turn.cross(outward) - d_slope * axis;
    const Eigen::Vector3d d_axis = turn.cross(axis) + d_slope * outward;
    const Eigen::Vector3d d_on_axis = shift - d_outward / tau + outward * d_tau / (tau * tau);
    result.col(i).head<2>() << d_axis.dot(frame.x), d_axis.dot(frame.y);
    if (shape.kind == SurfaceKind::kCylinder) {
      const Eigen::Vector3d from = frame.middle - shape.OnAxis();
      const Eigen::Vector3d d_beside = d_on_axis + from.dot(axis) * d_axis;
      result.col(i).tail<3>() << d_beside.dot(frame.x), d_beside.dot(frame.y),
          -Sign(tau) * d_tau / (tau * tau);
    } else if (shape.kind == SurfaceKind::kCone) {
      const double rise = RiseOf(shape);
      const double d_rise = -d_slope / (tau * sine * sine) - rise * d_tau / tau;
      result.col(i).tail<4>() << d_on_axis + d_rise * axis + rise * d_axis,
          Sign(sine * cosine) * d_slope;
    } else {
      const double radius = 1 / kappa, d_radius = -d_kappa / (kappa * kappa);
      const double over = 1 / tau - radius * cosine;
      const double d_over = -d_tau / (tau * tau) - d_radius * cosine + radius * sine * d_slope;
      result.col(i).tail<5>() << d_on_axis - (d_radius * sine + radius * cosine * d_slope) * axis -
                                     radius * sine * d_axis,
          Sign(over) * d_over, Sign(kappa) * d_radius;
    }
  }
  return result;
}

// The parameters according to an alternative shape: infinite where it has no such parameter, and
// where it is a limit.
Eigen::VectorXd ValuesOfAlternative(const FittedSurface& alternative,
                                    SurfaceKind kind,
                                    const AxisFrame& frame) {
  Eigen::VectorXd values = Eigen::VectorXd::Constant(FreedomsOf(kind), kInfinity);
  if (alternative.kind == kind) {
    values = ValuesOf(alternative, frame);
  } else if (kind >= SurfaceKind::kCylinder && alternative.kind != SurfaceKind::kSphere) {
    // Planes have their normals for axes where they are flat cones or tori; cylinders are bent to
    // tori in any direction across their axis.
    const bool across = kind == SurfaceKind::kTorus && alternative.kind == SurfaceKind::kCylinder;
    if (kind == SurfaceKind::kCone) {
      values[5] = alternative.kind == SurfaceKind::kPlane ? std::numbers::pi / 2 : 0;
    }
    if (kind != SurfaceKind::kCylinder && !across) {
      values.head<2>() << alternative.Direction().dot(frame.x),
          alternative.Direction().dot(frame.y);
    }
  }
  return values;
}

// Whether a curvature, or a cone's slope, changes its sign between two shapes: then radii or the
// apex pass through infinity.
bool ThroughInfinity(const FittedSurface& from, const FittedSurface& to) {
  const auto changes = [](double a, double b) { return !(a * b > 0); };
  switch (from.kind) {
    case SurfaceKind::kPlane:
      return false;
    case SurfaceKind::kSphere:
      return changes(from.curvature, to.curvature);
    case SurfaceKind::kCylinder:
      return changes(from.axis_curvature, to.axis_curvature);
    case SurfaceKind::kCone:
      return changes(from.axis_curvature, to.axis_curvature) ||
             changes(std::sin(from.slope), std::sin(to.slope));
    case SurfaceKind::kTorus:
      break;
  }
  return changes(from.axis_curvature, to.axis_curvature) || changes(from.curvature, to.curvature);
}

// The usual distance of the points from the axis or centre that they bend about, of the smallest.
double SmallRadius(const FittedSurface& shape, const Eigen::Matrix3Xd& points) {
  switch (shape.kind) {
    case SurfaceKind::kPlane:
      return kInfinity;
    case SurfaceKind::kSphere:
    case SurfaceKind::kTorus:
      return 1 / std::abs(shape.curvature);
    case SurfaceKind::kCylinder:
      return 1 / std::abs(shape.axis_curvature);
    case SurfaceKind::kCone:
      break;
  }
  constexpr double kQuantile = 0.25;
  std::vector<double> radii;
  const Eigen::Vector3d foot = shape.OnAxis(), axis = shape.Axis();
  for (const auto& p : points.colwise()) radii.push_back((p - foot).cross(axis).norm());
  return QuantileInPlace(radii, kQuantile);
}

// The extent of the shape, its centre or apex included, in the data's units.
double ReachOf(const FittedSurface& shape, const ShapeFitter& fitter) {
  const Eigen::Matrix3Xd& points = fitter.starts().judges.points;
  double reach = (points.rowwise().maxCoeff() - points.rowwise().minCoeff()).norm();
  if (shape.kind == SurfaceKind::kSphere || shape.kind == SurfaceKind::kTorus) {
    reach = std::max(reach, 1 / std::abs(shape.curvature));
  }
  if (shape.kind == SurfaceKind::kTorus) {
    reach = std::max(reach, 1 / std::abs(shape.axis_curvature));
  }
  if (shape.kind == SurfaceKind::kCone) reach = std::max(reach, std::abs(RiseOf(shape)));
  return fitter.unit() * reach;
}

std::string Number(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

// Warnings for the user about parameters that the points determine poorly.
std::vector<std::string> WarningsOf(const ShapeEstimate& estimate, double reach) {
  std::vector<std::string> warnings;
  bool axis = false, place = false;
  for (size_t i = 0; i < estimate.names.size(); ++i) {
    const std::string& name = estimate.names[i];
    const double value = estimate.values[static_cast<Eigen::Index>(i)];
    const double deviation = estimate.standard_deviations[static_cast<Eigen::Index>(i)];
    if (name.starts_with("axis") || name.starts_with("normal")) {
      axis |= !(deviation <= kVagueAngle);
    } else if (name.starts_with("center") || name.starts_with("apex")) {
      place |= !(deviation <= kVague * reach);
    } else if (name.ends_with("radius") || name == "half_angle") {
      if (deviation <= kVague * value) continue;
      std::string words = name;
      std::replace(words.begin(), words.end(), '_', ' ');
      warnings.push_back("the points do not determine the " + words + ": " + Number(value) +
                         (std::isfinite(deviation)
                              ? " with a standard deviation of " + Number(deviation)
                              : ", or anything up to infinity"));
    }
  }
  const bool plane = estimate.names.back() == "normal_y";
  if (axis) {
    warnings.push_back(std::string("the points do not determine the direction of the ") +
                       (plane ? "normal" : "axis"));
  }
  if (place) {
    warnings.push_back(std::string("the points do not determine the place of the ") +
                       (estimate.names.back() == "half_angle" ? "apex" : "centre"));
  }
  return warnings;
}

bool IsAngle(const std::string& name) {
  return name.starts_with("axis") || name.starts_with("normal") || name == "half_angle";
}

}  // namespace

ShapeEstimate EstimateOf(const ShapeFit& fit,
                         ShapeFitter& fitter,
                         double rounding,
                         ThreadPool& pool) {
  const FreedomCovariance free =
      CovarianceOf(fit.local, fitter.Counting(fit), fit.loss, rounding, pool);
  ShapeEstimate estimate;
  estimate.names = NamesOf(fit.kind);
  estimate.inflation = free.inflation;
  AxisFrame frame;
  const Eigen::Vector3d direction = fit.local.Direction();
  frame.x = SteadyAcross(direction);
  frame.y = direction.cross(frame.x);
  frame.middle = fitter.starts().centroid;
  estimate.frame_x = frame.x;
  estimate.frame_y = frame.y;
  estimate.values = ValuesOf(fit.local, frame);
  const Eigen::MatrixXd by = DerivativesOf(fit.local, frame);
  estimate.covariance = by * free.covariance * by.transpose();
  estimate.standard_deviations = estimate.covariance.diagonal().cwiseMax(0).cwiseSqrt();
  for (Eigen::Index i = 0; i < estimate.values.size(); ++i) {
    double& deviation = estimate.standard_deviations[i];
    if (!std::isfinite(deviation)) {
      deviation = kInfinity;
      continue;
    }
    // The change of the freedoms, one standard deviation long, that changes the number most.
    Eigen::Matrix<double, 7, 1> step = Eigen::Matrix<double, 7, 1>::Zero();
    if (!(deviation > 0)) continue;
    step.head(fit.freedoms) = free.covariance * by.row(i).transpose() / deviation;
    for (const double side : {kThreeSigmas, -kThreeSigmas}) {
      const FittedSurface moved = Moved(fit.local, side * step);
      const double change = std::abs(ValuesOf(moved, frame)[i] - estimate.values[i]) / kThreeSigmas;
      if (!IsAngle(estimate.names[static_cast<size_t>(i)]) && ThroughInfinity(fit.local, moved)) {
        deviation = kInfinity;
      } else {
        deviation = std::max(deviation, change);
      }
    }
  }
  for (const AlternativeShape& alternative : fit.alternatives) {
    const Eigen::VectorXd other = ValuesOfAlternative(alternative.shape, fit.kind, frame);
    const double apart = std::clamp(std::sqrt(alternative.excess), 1.0, kThreeSigmas);
    for (Eigen::Index i = 0; i < other.size(); ++i) {
      const double change = std::abs(other[i] - estimate.values[i]) / apart;
      estimate.standard_deviations[i] = std::max(estimate.standard_deviations[i], change);
    }
  }
  // A cylinder that may be a plane may have its axis in any direction of that plane.
  if (fit.kind == SurfaceKind::kCylinder && !std::isfinite(estimate.standard_deviations[4])) {
    estimate.standard_deviations.head<4>().setConstant(kInfinity);
  }
  // A plane's turn about its longest line is undetermined where the width across it is near the
  // noise.
  constexpr double kDrowned = 4;
  if (fit.kind == SurfaceKind::kPlane) {
    const StartData& data = fitter.starts();
    const Eigen::RowVectorXd across =
        data.inertia_axes.col(1).transpose() * (data.judges.points.colwise() - data.centroid);
    const double width = across.norm() / std::sqrt(static_cast<double>(across.size()));
    if (width < kDrowned * fit.sigma / fitter.unit()) {
      estimate.standard_deviations.tail<2>().setConstant(std::numbers::pi / 2);
    }
  }
  const double noise = std::max(fit.sigma / fitter.unit(), rounding);
  if (SmallRadius(fit.local, fitter.starts().judges.points) < kDrowned * noise) {
    estimate.warnings.push_back(std::string("the ") + Name(fit.kind) +
                                " is hardly thicker than the noise: its numbers mean nothing");
    estimate.standard_deviations.setConstant(kInfinity);
  }
  // Converts to the data's units and place.
  Eigen::VectorXd units = Eigen::VectorXd::Ones(estimate.values.size());
  for (Eigen::Index i = 0; i < units.size(); ++i) {
    const std::string& name = estimate.names[static_cast<size_t>(i)];
    if (!IsAngle(name)) units[i] = fitter.unit();
  }
  estimate.values = units.cwiseProduct(estimate.values);
  estimate.standard_deviations = units.cwiseProduct(estimate.standard_deviations);
  estimate.covariance = units.asDiagonal() * estimate.covariance * units.asDiagonal();
  for (size_t i = 0; i + 2 < estimate.names.size(); ++i) {
    const std::string& name = estimate.names[i];
    if (name == "center_x" || name == "apex_x") {
      estimate.values.segment<3>(static_cast<Eigen::Index>(i)) += fitter.middle();
    }
  }
  for (std::string& warning : WarningsOf(estimate, ReachOf(fit.local, fitter))) {
    estimate.warnings.push_back(std::move(warning));
  }
  return estimate;
}

}  // namespace batten::internal
