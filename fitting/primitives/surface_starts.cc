// SPDX-License-Identifier: MIT
#include "fitting/primitives/surface_starts.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "batten/fitting/point_mask.h"
#include "fitting/primitives/algebraic_fits.h"
#include "fitting/primitives/local_bend.h"
#include "fitting/primitives/normal_axes.h"
#include "geometry/numeric/dense_solvers.h"

namespace batten::internal {
namespace {

constexpr double kFarthestCurvature = 1e4;  // of unit data: beyond, starts are of no use

bool Usable(const FittedSurface& shape) {
  const double most = std::max(std::abs(shape.curvature), std::abs(shape.axis_curvature));
  return shape.point.allFinite() && shape.normal.allFinite() && shape.along.allFinite() &&
         std::isfinite(shape.slope) && most < kFarthestCurvature;
}

// The surface with this bend at its point; `profile` is the principal direction along the meridian.
FittedSurface BentAs(SurfaceKind kind, const Bend& bend, int profile, double slope) {
  FittedSurface shape;
  shape.kind = kind;
  shape.point = bend.point;
  shape.normal = bend.normal;
  shape.along = bend.directions[profile];
  shape.axis_curvature = bend.curvatures[1 - profile] / std::cos(slope);
  shape.slope = slope;
  if (kind == SurfaceKind::kTorus) shape.curvature = bend.curvatures[profile];
  if (kind == SurfaceKind::kSphere) {
    shape.curvature = (bend.curvatures[0] + bend.curvatures[1]) / 2;
    shape.axis_curvature = 0;
  }
  return shape;
}

std::vector<FittedSurface> BentStarts(SurfaceKind kind, const StartData& data) {
  constexpr double kSlopes[] = {0, 0.8, -0.8};
  std::vector<FittedSurface> starts;
  for (const Bend& bend : BendsNear(data.middle, data.judges.points)) {
    const int flatter = std::abs(bend.curvatures[0]) < std::abs(bend.curvatures[1]) ? 0 : 1;
    for (const double slope : kSlopes) {
      if (slope != 0 && kind < SurfaceKind::kCone) continue;
      starts.push_back(BentAs(kind, bend, flatter, slope));
      if (kind == SurfaceKind::kTorus) starts.push_back(BentAs(kind, bend, 1 - flatter, slope));
    }
  }
  return starts;
}

std::vector<FittedSurface> PlaneStarts(const StartData& data) {
  std::vector<FittedSurface> starts{PlaneAt(data.centroid, data.inertia_axes.col(2))};
  for (const OrientedPoints& oriented : data.oriented) {
    const Eigen::Vector3d centroid = oriented.points.rowwise().mean();
    const Eigen::Matrix3Xd from = oriented.points.colwise() - centroid;
    starts.push_back(PlaneAt(centroid, EigenOf3(from * from.transpose()).vectors.col(0)));
  }
  return starts;
}

std::vector<FittedSurface> SphereStarts(const StartData& data) {
  std::vector<FittedSurface> starts{AlgebraicSphereFit(data.sample.points)};
  for (const OrientedPoints& oriented : data.oriented) {
    starts.push_back(AlgebraicSphereFit(oriented.points));
  }
  return starts;
}

// Directions spread evenly over half a sphere by the golden angle.
std::vector<Eigen::Vector3d> Directions(int count) {
  std::vector<Eigen::Vector3d> directions;
  for (int k = 0; k < count; ++k) {
    const double z = (k + 0.5) / count, angle = k * std::numbers::pi * (3 - std::sqrt(5.0));
    const double radius = std::sqrt(1 - z * z);
    directions.emplace_back(radius * std::cos(angle), radius * std::sin(angle), z);
  }
  return directions;
}

std::vector<FittedSurface> CylinderStarts(const StartData& data) {
  constexpr int kDirections = 24;
  std::vector<FittedSurface> starts;
  for (const OrientedPoints& oriented : data.oriented) {
    const Eigen::Matrix3d axes = AcrossNormals(oriented);
    for (int i = 0; i < 2; ++i)
      starts.push_back(AlgebraicCylinderFit(oriented.points, axes.col(i)));
  }
  for (int i = 0; i < 3; ++i) {
    starts.push_back(AlgebraicCylinderFit(data.judges.points, data.inertia_axes.col(i)));
  }
  for (const Eigen::Vector3d& direction : Directions(kDirections)) {
    starts.push_back(AlgebraicCylinderFit(data.judges.points, direction));
  }
  return starts;
}

// Cones or tori about the lines that normals meet, and about the axes of inertia.
std::vector<FittedSurface> RevolvedStarts(SurfaceKind kind, const StartData& data) {
  const auto through = [&](const Eigen::Matrix3Xd& points, const Axis& axis) {
    return kind == SurfaceKind::kCone ? AlgebraicConeFit(points, axis)
                                      : AlgebraicTorusFit(points, axis);
  };
  std::vector<FittedSurface> starts;
  for (const OrientedPoints& oriented : data.oriented) {
    const std::vector<Axis> axes = LinesMeetingNormals(oriented);
    for (int i = 0; i < 2; ++i) starts.push_back(through(oriented.points, axes[i]));
    if (kind != SurfaceKind::kCone) continue;
    if (const auto cone = ConeOfTangentPlanes(oriented, data.middle)) starts.push_back(*cone);
  }
  for (int i = 0; i < 3; ++i) {
    starts.push_back(through(data.judges.points, {data.centroid, data.inertia_axes.col(i)}));
  }
  return starts;
}

}  // namespace

void TakeMoments(StartData& start) {
  const Eigen::Matrix3Xd& points = start.sample.points;
  start.centroid = points * start.sample.weights / start.sample.weights.sum();
  const Eigen::Matrix3Xd from = points.colwise() - start.centroid;
  Eigen::Index nearest;
  from.colwise().squaredNorm().minCoeff(&nearest);
  start.middle = points.col(nearest);
  start.inertia_axes = EigenOf3(from * start.sample.weights.asDiagonal() * from.transpose())
                           .vectors.rowwise()
                           .reverse();
}

StartData MakeStartData(const ShapeData& data,
                        Eigen::Index most,
                        std::uint64_t seed,
                        ThreadPool& pool) {
  StartData start;
  const auto part = [&](const ShapeData& of, Eigen::Index count) {
    const std::vector<Eigen::Index> chosen = SampleIndices(of.points.cols(), count, seed);
    return ShapeData{of.points(Eigen::all, chosen), of.weights(chosen)};
  };
  start.sample = part(data, most);
  start.judges = part(start.sample, kShapeJudges);
  start.oriented = OrientedSamples(start.sample.points, seed, pool);
  std::erase_if(start.oriented, [](const OrientedPoints& o) { return o.points.cols() < 8; });
  TakeMoments(start);
  return start;
}

std::vector<FittedSurface> MomentStarts(SurfaceKind kind, const StartData& data) {
  std::vector<FittedSurface> starts;
  switch (kind) {
    case SurfaceKind::kPlane:
      starts = PlaneStarts(data);
      break;
    case SurfaceKind::kSphere:
      starts = SphereStarts(data);
      break;
    case SurfaceKind::kCylinder:
      starts = CylinderStarts(data);
      break;
    case SurfaceKind::kCone:
    case SurfaceKind::kTorus:
      starts = RevolvedStarts(kind, data);
      break;
  }
  if (kind != SurfaceKind::kPlane) {
    const std::vector<FittedSurface> bent = BentStarts(kind, data);
    starts.insert(starts.end(), bent.begin(), bent.end());
  }
  std::erase_if(starts, [](const FittedSurface& shape) { return !Usable(shape); });
  return starts;
}

std::vector<FittedSurface> StartsFromCylinder(SurfaceKind kind,
                                              const FittedSurface& cylinder,
                                              const StartData& data) {
  std::vector<FittedSurface> starts;
  if (kind == SurfaceKind::kCone) {
    constexpr double kSlopes[] = {0, 0.3, -0.3};
    for (const double slope : kSlopes) {
      FittedSurface cone = cylinder;
      cone.kind = SurfaceKind::kCone;
      cone.slope = slope;
      cone.axis_curvature /= std::cos(slope);
      starts.push_back(cone);
    }
    return starts;
  }
  if (kind != SurfaceKind::kTorus || !(std::abs(cylinder.axis_curvature) > 0)) return starts;
  // Residuals as a change of radius and the axis' shift, tilt and bend, at each point's azimuth.
  const Eigen::Matrix3Xd& points = data.judges.points;
  const Eigen::Vector3d a = cylinder.along, b = cylinder.Across();
  const double radius = 1 / cylinder.axis_curvature;
  const Eigen::Vector3d foot = cylinder.point - radius * cylinder.normal;
  Eigen::MatrixXd design(points.cols(), 7);
  Eigen::VectorXd residuals(points.cols());
  for (Eigen::Index k = 0; k < points.cols(); ++k) {
    const Eigen::Vector3d from = points.col(k) - foot;
    const double h = from.dot(a), angle = std::atan2(from.dot(b), from.dot(cylinder.normal));
    const double c = std::cos(angle), s = std::sin(angle);
    design.row(k) << 1, c, s, h * c, h * s, h * h / 2 * c, h * h / 2 * s;
    residuals[k] = std::hypot(from.dot(b), from.dot(cylinder.normal)) - std::abs(radius);
  }
  const Eigen::VectorXd bend = LeastSquares(design, residuals);
  if (!bend.allFinite()) return starts;
  const Eigen::Vector2d curve = bend.tail<2>();
  const double size = std::max(curve.norm(), 1e-6);
  const Eigen::Vector3d inward = (curve[0] * cylinder.normal + curve[1] * b).norm() > 0
                                     ? (curve[0] * cylinder.normal + curve[1] * b).normalized()
                                     : b;
  const Eigen::Vector3d axis = a.cross(inward).normalized();
  const double slope = std::atan2(cylinder.normal.dot(axis), -cylinder.normal.dot(inward));
  FittedSurface torus;
  torus.kind = SurfaceKind::kTorus;
  torus.point = cylinder.point;
  torus.normal = cylinder.normal;
  torus.along = std::cos(slope) * axis + std::sin(slope) * inward;
  torus.slope = slope;
  torus.curvature = 1 / radius;
  torus.axis_curvature = size / (1 + radius * size * std::cos(slope));
  if (Usable(torus)) starts.push_back(torus);
  return starts;
}

}  // namespace batten::internal
