// SPDX-License-Identifier: MIT
#include "fitting/primitives/surface_patch.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "fitting/primitives/angle_extent.h"
#include "fitting/primitives/sphere_patch.h"
#include "fitting/primitives/surface_places.h"
#include "geometry/numeric/constants.h"
#include "geometry/numeric/smallest_rectangle.h"

namespace batten::internal {
namespace {

[[noreturn]] void RefuseThin(const FittedSurface& shape) {
  throw std::invalid_argument(std::string("the points lie on one line of their ") +
                              Name(shape.kind) + ": they do not say how far it reaches");
}

// The columns of inliers and, where there are outliers, without isolated points: points with few
// others in their own cell and the eight around it. Cells are sized to hold sixteen points each on
// average.
Eigen::Matrix2Xd Supported(Eigen::Matrix2Xd places, const PointMask& outliers) {
  if (!outliers.any()) return places;
  constexpr double kPerCell = 16, kFew = 1.0 / 8;
  constexpr int kMostCells = 1024;
  Eigen::Matrix2Xd used(2, places.cols());
  Eigen::Index count = 0;
  for (Eigen::Index k = 0; k < places.cols(); ++k) {
    if (!outliers[k]) used.col(count++) = places.col(k);
  }
  used.conservativeResize(2, count);
  if (count < 4 * kPerCell) return used;
  const Eigen::Vector2d low = used.rowwise().minCoeff();
  const Eigen::Vector2d size = used.rowwise().maxCoeff() - low;
  if (!(size.minCoeff() > 0)) return used;
  const int cells =
      std::min(static_cast<int>(std::sqrt(static_cast<double>(count) / kPerCell)), kMostCells);
  const auto cell_of = [&](Eigen::Index k, int d) {
    return std::min(cells - 1, static_cast<int>((used(d, k) - low[d]) / size[d] * cells));
  };
  Eigen::ArrayXXi counts = Eigen::ArrayXXi::Zero(cells + 2, cells + 2);
  for (Eigen::Index k = 0; k < count; ++k) ++counts(cell_of(k, 0) + 1, cell_of(k, 1) + 1);
  std::vector<int> around(static_cast<size_t>(count));
  for (Eigen::Index k = 0; k < count; ++k) {
    around[k] = counts.block(cell_of(k, 0), cell_of(k, 1), 3, 3).sum();
  }
  std::vector<int> sorted = around;
  std::nth_element(sorted.begin(), sorted.begin() + count / 2, sorted.end());
  const double few = kFew * sorted[static_cast<size_t>(count / 2)];
  Eigen::Index kept = 0;
  for (Eigen::Index k = 0; k < count; ++k) {
    if (around[k] > few) used.col(kept++) = used.col(k);
  }
  used.conservativeResize(2, kept);
  return used;
}

Interval RangeOf(const Eigen::Matrix2Xd& places, int row, const FittedSurface& shape) {
  const Interval range{places.row(row).minCoeff(), places.row(row).maxCoeff()};
  if (!(range.upper > range.lower)) RefuseThin(shape);
  return range;
}

AngleRange AnglesOf(const Eigen::Matrix2Xd& places, int row, const FittedSurface& shape) {
  const auto angles = places.row(row);
  const AngleRange range = AnglesCovered({angles.begin(), angles.end()});
  if (!(range.sweep > 0)) RefuseThin(shape);
  return range;
}

// The same shape with a positive axis curvature.
FittedSurface Outwards(FittedSurface shape) {
  if (shape.axis_curvature < 0) {
    shape.axis_curvature = -shape.axis_curvature;
    shape.slope += std::numbers::pi;
  }
  return shape;
}

// Orients directions so that their largest component is positive.
Eigen::Vector3d Upright(const Eigen::Vector3d& direction) {
  Eigen::Index largest;
  direction.cwiseAbs().maxCoeff(&largest);
  return direction[largest] < 0 ? Eigen::Vector3d(-direction) : direction;
}

ExactSurface PlanePatch(const FittedSurface& shape,
                        const Eigen::Matrix3Xd& points,
                        const PointMask& outliers,
                        ThreadPool& pool) {
  const Eigen::Vector3d normal = Upright(shape.normal);
  const Frame plan(shape.point, normal);
  const Eigen::Matrix2Xd places =
      Supported(PlacesOf(points,
                         pool,
                         [&](const Eigen::Vector3d& p) -> Eigen::Vector2d {
                           const Eigen::Vector3d from = p - plan.origin();
                           return {from.dot(plan.x()), from.dot(plan.y())};
                         }),
                outliers);
  const TurnedRectangle box =
      SmallestRectangleAround(ConvexHullOf({places.colwise().begin(), places.colwise().end()}));
  if (!(box.high[0] > box.low[0] && box.high[1] > box.low[1])) RefuseThin(shape);
  const Eigen::Vector3d x = box.axis[0] * plan.x() + box.axis[1] * plan.y();
  const Eigen::Vector3d y = normal.cross(x);
  const Frame frame(shape.point + box.low[0] * x + box.low[1] * y, normal, x);
  return ExactPlane{frame, {0, box.high[0] - box.low[0]}, {0, box.high[1] - box.low[1]}};
}

// The angle about a frame's axis, and the height.
Eigen::Vector2d AboutAxis(const Frame& frame, const Eigen::Vector3d& p) {
  const Eigen::Vector3d from = p - frame.origin();
  return {std::atan2(from.dot(frame.y()), from.dot(frame.x())), from.dot(frame.axis())};
}

ExactSurface CylinderPatch(const FittedSurface& given,
                           const Eigen::Matrix3Xd& points,
                           const PointMask& outliers,
                           ThreadPool& pool) {
  const double radius = 1 / std::abs(given.axis_curvature);
  const Eigen::Vector3d axis = Upright(given.along);
  const Eigen::Vector3d foot = given.point - given.normal / given.axis_curvature;
  const Frame frame(foot, axis);
  const Eigen::Matrix2Xd places = Supported(
      PlacesOf(points, pool, [&](const Eigen::Vector3d& p) { return AboutAxis(frame, p); }),
      outliers);
  const Interval height = RangeOf(places, 1, given);
  return ExactCylinder{Frame(foot + height.lower * axis, axis, frame.x()),
                       radius,
                       {0, height.upper - height.lower},
                       AnglesOf(places, 0, given)};
}

// The profile's place is measured from the shape's point along `along`, so that the tip may be at
// any distance.
ExactSurface ConePatch(const FittedSurface& given,
                       const Eigen::Matrix3Xd& points,
                       const PointMask& outliers,
                       ThreadPool& pool) {
  const FittedSurface shape = Outwards(given);
  const double sine = std::sin(shape.slope), cosine = std::cos(shape.slope);
  const double radius = 1 / shape.axis_curvature;
  const Eigen::Vector3d axis = shape.Axis();
  const Frame frame(shape.point - radius * shape.Outward(), axis);
  const Eigen::Matrix2Xd places =
      Supported(PlacesOf(points,
                         pool,
                         [&](const Eigen::Vector3d& p) -> Eigen::Vector2d {
                           const Eigen::Vector3d from = p - frame.origin();
                           const double height = from.dot(axis);
                           const double over = (from - height * axis).norm() - radius;
                           return {AboutAxis(frame, p)[0], cosine * height - sine * over};
                         }),
                outliers);
  Interval along = RangeOf(places, 1, shape);
  // The apex, where the radius is zero and the cone ends.
  const double tip = radius / sine;
  if (sine > 0) along.upper = std::min(along.upper, tip);
  if (sine < 0) along.lower = std::max(along.lower, tip);
  if (!(along.upper > along.lower)) RefuseThin(shape);
  const auto radius_at = [&](double t) { return t == tip ? 0 : std::max(0.0, radius - t * sine); };
  double first = along.lower, second = along.upper;
  const double up = cosine < 0 ? -1 : 1;
  if (up < 0) std::swap(first, second);
  const Eigen::Vector3d upright = Upright(axis);
  if (upright.dot(axis) < 0) std::swap(first, second);
  const Eigen::Vector3d foot = frame.origin() + first * cosine * axis;
  const double height = std::abs((second - first) * cosine);
  const Frame placed(foot, upright, frame.x());
  if (!(height > 0)) RefuseThin(shape);
  AngleRange angles = AnglesOf(places, 0, shape);
  if (upright.dot(axis) < 0 && !angles.full()) {
    angles.start = -(angles.start + angles.sweep);
  }
  return ExactCone{placed, radius_at(first), radius_at(second), {0, height}, angles};
}

// The angles round the tube from the arc's middle. The arc of a spindle ends at the axis, where the
// angle's cosine is `cosine_at_axis` (a ring torus has none).
AngleRange TubeOf(const Eigen::Matrix2Xd& places,
                  double cosine_at_axis,
                  const FittedSurface& shape) {
  if (!(std::abs(cosine_at_axis) < 1)) return AnglesOf(places, 1, shape);
  const double end = std::acos(cosine_at_axis);
  const Interval range = RangeOf(places, 1, shape);
  const double start = std::max(range.lower, -end);
  return {start, std::min(range.upper, end) - start};
}

ExactSurface TorusPatch(const FittedSurface& given,
                        const Eigen::Matrix3Xd& points,
                        const PointMask& outliers,
                        ThreadPool& pool) {
  const FittedSurface shape = Outwards(given);
  const double profile = 1 / shape.curvature, minor = std::abs(profile);
  const double over = 1 / shape.axis_curvature - profile * std::cos(shape.slope);
  const Eigen::Vector3d center = shape.OnAxis() - profile * std::sin(shape.slope) * shape.Axis();
  const Frame frame(center, Upright(shape.Axis()));
  const bool lemon = over < 0;  // the inner arc of a spindle: across the axis from its circle
  const double side = lemon ? -1 : 1;
  const Eigen::Matrix2Xd places =
      Supported(PlacesOf(points,
                         pool,
                         [&](const Eigen::Vector3d& p) -> Eigen::Vector2d {
                           const Eigen::Vector2d at = AboutAxis(frame, p);
                           const Eigen::Vector3d from = p - center;
                           const double distance = (from - at[1] * frame.axis()).norm();
                           return {lemon ? std::remainder(at[0] + kTurn / 2, kTurn) : at[0],
                                   std::atan2(side * at[1], distance - over)};
                         }),
                outliers);
  AngleRange tube = TubeOf(places, -over / minor, shape);
  if (lemon) tube.start += kTurn / 2;
  return ExactTorus{frame, std::abs(over), minor, AnglesOf(places, 0, shape), tube};
}

// Directions from the sphere's centre in a chart about the middle of the points, where isolated
// points are detected.
ExactSurface SpherePatch(const FittedSurface& shape,
                         const Eigen::Matrix3Xd& points,
                         const PointMask& outliers,
                         ThreadPool& pool) {
  const Eigen::Vector3d center = shape.Center();
  const Eigen::Vector3d middle = (points.rowwise().mean() - center).normalized();
  const Frame seen(center, middle.allFinite() ? middle : Eigen::Vector3d::UnitZ());
  const Eigen::Matrix2Xd chart = Supported(
      PlacesOf(points,
               pool,
               [&](const Eigen::Vector3d& p) -> Eigen::Vector2d {
                 const Eigen::Vector2d at = AboutAxis(seen, p);
                 const double polar = std::acos(std::clamp(at[1] / (p - center).norm(), -1.0, 1.0));
                 return {polar * std::cos(at[0]), polar * std::sin(at[0])};
               }),
      outliers);
  Eigen::Matrix3Xd directions(3, chart.cols());
  for (Eigen::Index k = 0; k < chart.cols(); ++k) {
    const double polar = chart.col(k).norm();
    const Eigen::Vector2d along = polar > 0 ? (chart.col(k) / polar).eval() : Eigen::Vector2d(1, 0);
    directions.col(k) = std::cos(polar) * seen.axis() +
                        std::sin(polar) * (along[0] * seen.x() + along[1] * seen.y());
  }
  const SphereCover cover = CoverOf(directions);
  if (!(cover.longitude.sweep > 0 && cover.latitude.upper > cover.latitude.lower)) {
    RefuseThin(shape);
  }
  return ExactSphere{Frame(center, cover.axis, cover.x),
                     1 / std::abs(shape.curvature),
                     cover.longitude,
                     cover.latitude};
}

Frame Placed(const Frame& frame, double scale, const Eigen::Vector3d& shift) {
  return Frame(shift + scale * frame.origin(), frame.axis(), frame.x());
}

Interval Scaled(const Interval& range, double scale) {
  return {scale * range.lower, scale * range.upper};
}

}  // namespace

ExactSurface PatchOf(const FittedSurface& shape,
                     const Eigen::Matrix3Xd& points,
                     const PointMask& outliers,
                     ThreadPool& pool) {
  switch (shape.kind) {
    case SurfaceKind::kPlane:
      return PlanePatch(shape, points, outliers, pool);
    case SurfaceKind::kSphere:
      return SpherePatch(shape, points, outliers, pool);
    case SurfaceKind::kCylinder:
      return CylinderPatch(shape, points, outliers, pool);
    case SurfaceKind::kCone:
      return ConePatch(shape, points, outliers, pool);
    case SurfaceKind::kTorus:
      break;
  }
  return TorusPatch(shape, points, outliers, pool);
}

ExactSurface Placed(const ExactSurface& patch, double scale, const Eigen::Vector3d& shift) {
  ExactSurface placed = patch;
  std::visit([&](auto& shape) { shape.frame = Placed(shape.frame, scale, shift); }, placed);
  if (auto* plane = std::get_if<ExactPlane>(&placed)) {
    plane->x = Scaled(plane->x, scale);
    plane->y = Scaled(plane->y, scale);
  } else if (auto* sphere = std::get_if<ExactSphere>(&placed)) {
    sphere->radius *= scale;
  } else if (auto* cylinder = std::get_if<ExactCylinder>(&placed)) {
    cylinder->radius *= scale;
    cylinder->height = Scaled(cylinder->height, scale);
  } else if (auto* cone = std::get_if<ExactCone>(&placed)) {
    cone->radius_lower *= scale;
    cone->radius_upper *= scale;
    cone->height = Scaled(cone->height, scale);
  } else {
    ExactTorus& torus = std::get<ExactTorus>(placed);
    torus.major *= scale;
    torus.minor *= scale;
  }
  return placed;
}

}  // namespace batten::internal
