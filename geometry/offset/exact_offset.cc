// SPDX-License-Identifier: MIT
#include "geometry/offset/exact_offset.h"

#include <Eigen/Geometry>
#include <cmath>
#include <stdexcept>
#include <utility>
#include <variant>

#include "batten/geometry/classify_shape.h"
#include "batten/geometry/exact_shape.h"

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

// Whether S_u × S_v looks out of the tube at some places and into it at others: on the two sides of
// the place where a spindle meets its axis.
bool TurnsRound(const NurbsSurface& surface, const TorusShape& torus) {
  if (!(torus.minor_radius > torus.major_radius)) return false;
  constexpr int kPlaces = 32;  // a direction: arcs of a thirtieth of the patch are seen
  const SplineBasis &U = surface.basis_u(), &V = surface.basis_v();
  bool outward = false, inward = false;
  for (int k = 0; k < kPlaces * kPlaces; ++k) {
    const double u = U.lower() + (k / kPlaces + 0.5) / kPlaces * (U.upper() - U.lower());
    const double v = V.lower() + (k % kPlaces + 0.5) / kPlaces * (V.upper() - V.lower());
    const auto normal = surface.NormalAt(u, v);
    if (!normal) continue;
    const Eigen::Vector3d from = surface.At(u, v) - torus.center;
    const Eigen::Vector3d flat = from - from.dot(torus.axis) * torus.axis;
    const Eigen::Vector3d middle = torus.major_radius * flat.normalized();
    const double here = std::abs((from - middle).norm() - torus.minor_radius);
    const double across = std::abs((from + middle).norm() - torus.minor_radius);
    const double side = normal->dot(here < across ? Eigen::Vector3d(from - middle)
                                                  : Eigen::Vector3d(from + middle));
    (side > 0 ? outward : inward) = true;
  }
  return outward && inward;
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
    const Eigen::Vector3d offset = place.point - torus->frame.origin();
    const Eigen::Vector3d flat = offset - offset.dot(torus->frame.axis()) * torus->frame.axis();
    const Eigen::Vector3d spoke = offset - torus->major * flat.normalized();
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
  const TorusShape* torus = std::get_if<TorusShape>(&shape);
  if (torus != nullptr && TurnsRound(surface, *torus)) {
    throw std::invalid_argument(
        "OffsetSurface: the torus passes its axis, where its normal turns round: offset its inner "
        "and its outer arc each by itself");
  }
  const auto exact = ExactShapeOf(surface);
  return exact ? MadeAgain(*exact, *place, distance) : std::nullopt;
}

}  // namespace batten::internal
