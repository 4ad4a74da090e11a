// SPDX-License-Identifier: MIT
#include "fitting/regions/smooth_contact.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace batten::internal {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

bool Turned(const FittedSurface& shape) { return shape.kind >= SurfaceKind::kCylinder; }

// A line or circle of the plane near a place: its centre is at − normal/curvature.
struct Profile {
  Vector2d at, normal;
  double curvature = 0;

  Vector2d Center() const { return at - normal / curvature; }
};

struct ProfileContact {
  double gap = 0;
  Vector2d at, normal;
};

std::optional<ProfileContact> Touching(Profile a, Profile b) {
  constexpr double kAlike =
      0.05;  // of the larger curvature: circles that differ less touch nowhere
  if (a.normal.dot(b.normal) < 0) {
    b.normal = -b.normal;
    b.curvature = -b.curvature;
  }
  const double most = std::max(std::abs(a.curvature), std::abs(b.curvature));
  if (!(std::abs(a.curvature - b.curvature) > kAlike * most)) return std::nullopt;
  if (b.curvature == 0) std::swap(a, b);
  const Vector2d center = b.Center();
  const double radius = 1 / b.curvature;
  if (a.curvature == 0) {
    return ProfileContact{
        (center - a.at).dot(a.normal) + radius, center + radius * a.normal, a.normal};
  }
  const Vector2d between = a.Center() - center;
  const double apart = radius - 1 / a.curvature;
  const Vector2d normal = between.normalized() * (apart > 0 ? 1 : -1);
  return ProfileContact{between.norm() - std::abs(apart), center + radius * normal, normal};
}

// A plane of coordinates in which both shapes are lines or circles.
struct Section {
  Vector3d origin, x, y;

  Vector2d In(const Vector3d& v) const { return {v.dot(x), v.dot(y)}; }
  Profile Of(const FittedSurface& touching, double curvature) const {
    return {In(touching.point - origin), In(touching.normal).normalized(), curvature};
  }
  Vector3d At(const Vector2d& p) const { return origin + p[0] * x + p[1] * y; }
};

struct Found {
  std::vector<double> aside;  // what has to be zero besides the contact in the section
  Section section;
  std::optional<ProfileContact> contact;
};

void Add(const Vector3d& off, const Vector3d& axis, std::vector<double>& to) {
  const Vector3d x = axis.unitOrthogonal();
  to.push_back(off.dot(x));
  to.push_back(off.dot(axis.cross(x)));
}

// Planes and cylinders across the direction of the first cylinder.
std::optional<Found> Straight(const Vector3d& near, FittedSurface a, FittedSurface b) {
  const auto flat = [](const FittedSurface& s) { return s.kind == SurfaceKind::kPlane; };
  const auto round = [](const FittedSurface& s) { return s.kind == SurfaceKind::kCylinder; };
  if (!round(a)) std::swap(a, b);
  if (!round(a) || !(flat(b) || round(b))) return std::nullopt;
  const Vector3d along = a.Axis();
  Found found;
  if (flat(b)) {
    found.aside.push_back(along.dot(b.normal));
  } else {
    Add(b.Axis(), along, found.aside);
  }
  const Vector3d x = along.unitOrthogonal();
  found.section = {near, x, along.cross(x)};
  const FittedSurface here = a.TouchingNear(near), there = b.TouchingNear(near);
  found.contact = Touching(found.section.Of(here, here.axis_curvature),
                           found.section.Of(there, flat(b) ? 0 : there.axis_curvature));
  return found;
}

// Half-planes through the axis of the first that has one.
std::optional<Found> Round(const Vector3d& near, FittedSurface a, FittedSurface b) {
  if (!Turned(a)) std::swap(a, b);
  if (!Turned(a)) return std::nullopt;
  const Vector3d axis = a.Axis(), foot = a.OnAxis();
  Found found;
  if (b.kind == SurfaceKind::kPlane) {
    Add(b.normal, axis, found.aside);
  } else if (b.kind == SurfaceKind::kSphere) {
    Add(b.Center() - foot, axis, found.aside);
  } else {
    Add(b.Axis(), axis, found.aside);
    Add(b.OnAxis() - foot, axis, found.aside);
  }
  const Vector3d from = near - foot;
  const Vector3d out = from - from.dot(axis) * axis;
  if (!(out.norm() > 0)) return std::nullopt;
  found.section = {foot, out.normalized(), axis};
  const FittedSurface here = a.TouchingNear(near), there = b.TouchingNear(near);
  found.contact =
      Touching(found.section.Of(here, here.curvature), found.section.Of(there, there.curvature));
  return found;
}

// The circle that is the middle of a torus.
struct Spine {
  Vector3d center, axis;
  double radius;
};

Spine SpineOf(const FittedSurface& torus) {
  const Vector3d axis = torus.Axis(), foot = torus.OnAxis(), tube = torus.Center();
  const double height = (tube - foot).dot(axis);
  const Vector3d center = foot + height * axis;
  return {center, axis, (tube - center).norm()};
}

// A torus and a cylinder or sphere of its tube's radius; the plane across both middles.
std::optional<std::pair<Eigen::VectorXd, FittedSurface>> Pipe(FittedSurface a, FittedSurface b) {
  if (a.kind != SurfaceKind::kTorus) std::swap(a, b);
  const bool ball = b.kind == SurfaceKind::kSphere;
  if (a.kind != SurfaceKind::kTorus || !(ball || b.kind == SurfaceKind::kCylinder)) {
    return std::nullopt;
  }
  const Spine spine = SpineOf(a);
  const Vector3d way = ball ? Vector3d::Zero() : b.Axis();
  Vector3d middle = ball ? b.Center() : b.OnAxis();
  middle -= (middle - spine.center).dot(way) * way;  // of an axis, nearest to the torus' centre
  const Vector3d off = middle - spine.center;
  const double height = off.dot(spine.axis);
  Eigen::VectorXd gap(ball ? 3 : 4);
  gap.head<3>() << b.PipeRadius() - a.PipeRadius(), height,
      (off - height * spine.axis).norm() - spine.radius;
  if (!ball) gap[3] = way.dot(spine.axis);
  const Vector3d across = ball ? spine.axis.cross(off).normalized() : way;
  return std::pair(gap, PlaneAt(middle, across));
}

std::optional<Found> InSection(const SmoothContact& contact,
                               const FittedSurface& a,
                               const FittedSurface& b) {
  return contact.kind == ContactKind::kStraight ? Straight(contact.near, a, b)
                                                : Round(contact.near, a, b);
}

}  // namespace

std::optional<Eigen::VectorXd> ContactGap(const SmoothContact& contact,
                                          const FittedSurface& a,
                                          const FittedSurface& b) {
  if (contact.kind == ContactKind::kPipe) {
    const auto pipe = Pipe(a, b);
    return pipe ? std::optional(pipe->first) : std::nullopt;
  }
  const auto found = InSection(contact, a, b);
  if (!found || !found->contact) return std::nullopt;
  Eigen::VectorXd gap(std::ssize(found->aside) + 1);
  gap << Eigen::Map<const Eigen::VectorXd>(found->aside.data(), std::ssize(found->aside)),
      found->contact->gap;
  return gap;
}

FittedSurface NormalsAlong(const SmoothContact& contact,
                           const FittedSurface& a,
                           const FittedSurface& b) {
  if (contact.kind == ContactKind::kPipe) return Pipe(a, b)->second;
  constexpr double kAcross = 1e-7;
  const Found found = *InSection(contact, a, b);
  const auto& [origin, x, y] = found.section;
  const Vector2d at = found.contact->at, normal = found.contact->normal;
  const Vector3d place = found.section.At(at);
  if (contact.kind == ContactKind::kStraight) {
    return PlaneAt(place, x * -normal[1] + y * normal[0]);
  }
  if (std::abs(normal[1]) < kAcross) return PlaneAt(place, y);
  if (std::abs(normal[0]) < kAcross) return CylinderNear(place, origin, y, at[0]);
  // The normals meet on the axis.
  const double apex = at[1] - at[0] * normal[1] / normal[0];
  const Vector3d axis = at[1] > apex ? y : Vector3d(-y);
  return ConeNear(place, origin + apex * y, axis, std::atan(std::abs(normal[0] / normal[1])));
}

}  // namespace batten::internal
