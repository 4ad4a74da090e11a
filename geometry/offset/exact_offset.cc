// SPDX-License-Identifier: MIT
#include "geometry/offset/exact_offset.h"

#include <Eigen/Geometry>
#include <cmath>
#include <utility>
#include <variant>

#include "batten/geometry/classify_shape.h"
#include "batten/geometry/exact_shape.h"
#include "geometry/numeric/constants.h"

namespace batten::internal {
namespace {

// A place with a normal, from which it is seen to which side that points.
struct NormalPlace {
  Eigen::Vector3d point, normal;
};

std::optional<NormalPlace> PlaceInside(const NurbsSurface& surface) {
  const SplineBasis &U = surface.basis_u(), &V = surface.basis_v();
  constexpr double kShare = 0.37;
  const double u = U.lower() + kShare * (U.upper() - U.lower());
  const double v = V.lower() + kShare * (V.upper() - V.lower());
  const auto normal = surface.NormalAt(u, v);
  if (!normal) return std::nullopt;
  return NormalPlace{surface.At(u, v), *normal};
}

NurbsSurface WithNet(const NurbsSurface& surface, Eigen::Matrix3Xd points) {
  return NurbsSurface(surface.basis_u(), surface.basis_v(), std::move(points), surface.weights());
}

// Whether a spindle's tube passes the axis, beyond which S_u × S_v looks to the tube's other side.
bool PassesAxis(const ExactTorus& torus) {
  if (!(torus.minor > torus.major)) return false;
  constexpr double kRounding = 1e-12;  // radians
  const double at_axis = std::acos(-torus.major / torus.minor), start = torus.tube.start;
  const auto inside = [&](double angle) {
    const double first = angle + kTurn * std::ceil((start + kRounding - angle) / kTurn);
    return first < start + torus.tube.sweep - kRounding;
  };
  return inside(at_axis) || inside(-at_axis);
}

// The cone's radii grow by d cos α and its heights by −d sin α, tan α the slope of the radius: its
// outward normal is (cos α, −sin α).
std::optional<NurbsSurface> MadeAgain(ExactSurface shape,
                                      const NormalPlace& place,
                                      double distance) {
  if (ExactCone* cone = std::get_if<ExactCone>(&shape)) {
    const Eigen::Vector3d offset = place.point - cone->frame.origin();
    const Eigen::Vector3d radial = offset - offset.dot(cone->frame.axis()) * cone->frame.axis();
    const double out = std::copysign(distance, distance * place.normal.dot(radial));
    const double rise = cone->height.upper - cone->height.lower;
    const double slope = (cone->radius_upper - cone->radius_lower) / rise;
    const double cosine = 1 / std::hypot(1.0, slope), sine = slope * cosine;
    cone->radius_lower += out * cosine;
    cone->radius_upper += out * cosine;
    cone->height.lower -= out * sine;
    cone->height.upper -= out * sine;
    if (cone->radius_lower < 0 || cone->radius_upper < 0) return std::nullopt;
    return ToNurbs(shape);
  }
  if (ExactTorus* torus = std::get_if<ExactTorus>(&shape)) {
    if (PassesAxis(*torus)) return std::nullopt;
    const Eigen::Vector3d offset = place.point - torus->frame.origin();
    const Eigen::Vector3d flat = offset - offset.dot(torus->frame.axis()) * torus->frame.axis();
    const Eigen::Vector3d middle = torus->major * flat.normalized();
    const auto off = [&](const Eigen::Vector3d& spoke) {
      return std::abs(spoke.norm() - torus->minor);
    };
    // On the inner arc of a spindle the middle of the tube is across the axis.
    Eigen::Vector3d spoke = offset - middle;
    if (off(offset + middle) < off(spoke)) spoke = offset + middle;
    torus->minor += std::copysign(distance, distance * place.normal.dot(spoke));
    if (!(torus->minor > 0)) return std::nullopt;
    return ToNurbs(shape);
  }
  return std::nullopt;
}

}  // namespace

std::optional<NurbsSurface> ExactSurfaceOffset(const NurbsSurface& surface, double distance) {
  const auto place = PlaceInside(surface);
  if (!place) return std::nullopt;
  constexpr double kExact = 1e-13;
  const SurfaceShape shape = ClassifyShape(surface, {.tolerance = kExact});
  Eigen::Matrix3Xd points = surface.control_points();
  if (std::holds_alternative<PlaneShape>(shape)) {
    points.colwise() += distance * place->normal;
    return WithNet(surface, std::move(points));
  }
  if (const SphereShape* sphere = std::get_if<SphereShape>(&shape)) {
    const double out =
        distance * std::copysign(1.0, place->normal.dot(place->point - sphere->center));
    const double ratio = 1 + out / sphere->radius;
    points = (ratio * (points.colwise() - sphere->center)).colwise() + sphere->center;
    return WithNet(surface, std::move(points));
  }
  if (const CylinderShape* cylinder = std::get_if<CylinderShape>(&shape)) {
    const Eigen::Matrix3d flat =
        Eigen::Matrix3d::Identity() - cylinder->axis * cylinder->axis.transpose();
    const double out =
        distance * std::copysign(1.0, place->normal.dot(flat * (place->point - cylinder->point)));
    points += out / cylinder->radius * (flat * (points.colwise() - cylinder->point));
    return WithNet(surface, std::move(points));
  }
  const auto exact = ExactShapeOf(surface);
  return exact ? MadeAgain(*exact, *place, distance) : std::nullopt;
}

}  // namespace batten::internal
