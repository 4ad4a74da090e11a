// SPDX-License-Identifier: MIT
// Pieces of planes, spheres, cylinders, cones and tori anywhere in space, points on them, and how
// far points are from such shapes by their centres and axes.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <variant>

#include "fitting/primitives/fitted_surface.h"
#include "random_splines.h"

namespace batten::internal {

inline double DistanceTo(const SurfaceShape& shape, const Eigen::Vector3d& p) {
  const auto place = [&](const Eigen::Vector3d& on_axis, const Eigen::Vector3d& axis) {
    const Eigen::Vector3d from = p - on_axis;
    return Eigen::Vector2d(from.cross(axis).norm(), from.dot(axis));  // from the axis, along it
  };
  if (const auto* s = std::get_if<PlaneShape>(&shape)) return std::abs(s->normal.dot(p - s->point));
  if (const auto* s = std::get_if<SphereShape>(&shape)) {
    return std::abs((p - s->center).norm() - s->radius);
  }
  if (const auto* s = std::get_if<CylinderShape>(&shape)) {
    return std::abs(place(s->point, s->axis)[0] - s->radius);
  }
  if (const auto* s = std::get_if<ConeShape>(&shape)) {
    const Eigen::Vector2d at = place(s->apex, s->axis);
    return std::abs(std::cos(s->half_angle) * at[0] - std::sin(s->half_angle) * at[1]);
  }
  const TorusShape& s = std::get<TorusShape>(shape);
  const Eigen::Vector2d at = place(s.center, s.axis);
  return std::min(std::abs(std::hypot(at[0] - s.major_radius, at[1]) - s.minor_radius),
                  std::abs(std::hypot(at[0] + s.major_radius, at[1]) - s.minor_radius));
}

inline FittedSurface TouchingNear(const SurfaceShape& shape, const Eigen::Vector3d& p) {
  if (const auto* s = std::get_if<PlaneShape>(&shape)) return PlaneAt(s->point, s->normal);
  if (const auto* s = std::get_if<SphereShape>(&shape)) return SphereNear(p, s->center, s->radius);
  if (const auto* s = std::get_if<CylinderShape>(&shape)) {
    return CylinderNear(p, s->point, s->axis, s->radius);
  }
  if (const auto* s = std::get_if<ConeShape>(&shape)) {
    return ConeNear(p, s->apex, s->axis, s->half_angle);
  }
  const TorusShape& s = std::get<TorusShape>(shape);
  return TorusNear(p, s.center, s.axis, s.major_radius, s.minor_radius);
}

// A shape about the z axis and the origin (a cone's apex), then turned and shifted.
struct MeasuredShape {
  SurfaceKind kind = SurfaceKind::kPlane;
  double radius = 1;  // of a sphere, a cylinder, the profile of a torus
  double major_radius = 2;
  double half_angle = 0.5;
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();
  SurfaceShape shape;  // the same, in place

  void Place() {
    const Eigen::Vector3d axis = turn.col(2);
    switch (kind) {
      case SurfaceKind::kPlane:
        shape = PlaneShape{shift, axis};
        break;
      case SurfaceKind::kSphere:
        shape = SphereShape{shift, radius};
        break;
      case SurfaceKind::kCylinder:
        shape = CylinderShape{shift, axis, radius};
        break;
      case SurfaceKind::kCone:
        shape = ConeShape{shift, axis, half_angle};
        break;
      case SurfaceKind::kTorus:
        shape = TorusShape{shift, axis, major_radius, radius};
        break;
    }
  }

  // u: x of a plane, else the angle about the axis; v: y of a plane, the height on a cylinder, the
  // distance from a cone's apex, the latitude on a sphere, the profile's angle on a torus.
  Eigen::Vector3d At(double u, double v) const {
    if (kind == SurfaceKind::kPlane) return turn * Eigen::Vector3d(u, v, 0) + shift;
    double over = radius, height = v;
    if (kind == SurfaceKind::kSphere) {
      over = radius * std::cos(v);
      height = radius * std::sin(v);
    } else if (kind == SurfaceKind::kCone) {
      over = v * std::sin(half_angle);
      height = v * std::cos(half_angle);
    } else if (kind == SurfaceKind::kTorus) {
      over = major_radius + radius * std::cos(v);
      height = radius * std::sin(v);
    }
    return turn * Eigen::Vector3d(over * std::cos(u), over * std::sin(u), height) + shift;
  }

  Eigen::Vector3d NormalAt(double u, double v) const {
    if (kind == SurfaceKind::kPlane) return turn.col(2);
    double over = 1, height = 0;
    if (kind == SurfaceKind::kSphere || kind == SurfaceKind::kTorus) {
      over = std::cos(v);
      height = std::sin(v);
    } else if (kind == SurfaceKind::kCone) {
      over = std::cos(half_angle);
      height = -std::sin(half_angle);
    }
    return turn * Eigen::Vector3d(over * std::cos(u), over * std::sin(u), height);
  }
};

struct ShapePiece {
  double u_start = 0, u_length = 1, v_start = 0, v_length = 1;
};

// About one unit in size, somewhere within `distance`.
inline MeasuredShape RandomShape(SurfaceKind kind, RandomSplines& random, double distance = 1) {
  MeasuredShape shape;
  shape.kind = kind;
  shape.turn = random.Orthogonal();
  if (shape.turn.determinant() < 0) shape.turn.col(0) *= -1;
  shape.shift = random.Vector(distance);
  shape.radius = kind == SurfaceKind::kTorus ? random.Real(0.1, 0.35) : random.Real(0.2, 0.6);
  shape.major_radius = random.Real(0.5, 0.8);
  shape.half_angle = random.Real(0.1, 1.2);
  shape.Place();
  return shape;
}

// What part of the shape: all round, or `part` of that in either direction.
inline ShapePiece PieceOf(const MeasuredShape& shape, double part, RandomSplines& random) {
  constexpr double kTurn = 2 * std::numbers::pi;
  ShapePiece piece;
  piece.u_start = random.Real(0, kTurn);
  piece.u_length = part * kTurn;
  switch (shape.kind) {
    case SurfaceKind::kPlane:
      piece = {-0.5, 1, -0.5 * part, part};
      break;
    case SurfaceKind::kSphere:
      piece.v_length = part * std::numbers::pi;
      piece.v_start = random.Real(-0.5, 0.5 - part) * std::numbers::pi;
      break;
    case SurfaceKind::kCylinder:
      piece.v_length = random.Real(0.3, 1.5);
      piece.v_start = random.Real(-1, 1);
      break;
    case SurfaceKind::kCone:
      piece.v_start = random.Real(0.05, 1);
      piece.v_length = random.Real(0.3, 1.0);
      break;
    case SurfaceKind::kTorus:
      piece.v_start = random.Real(0, kTurn);
      piece.v_length = std::max(part, 0.25) * kTurn;
      break;
  }
  return piece;
}

inline ShapePiece RandomPiece(const MeasuredShape& shape, RandomSplines& random) {
  constexpr double kParts[] = {1, 0.5, 0.25, 0.12};
  return PieceOf(shape, kParts[random.Integer(0, 3)], random);
}

inline Eigen::Matrix3Xd RandomPoints(const MeasuredShape& shape,
                                     const ShapePiece& piece,
                                     int count,
                                     RandomSplines& random,
                                     double sigma = 0) {
  std::mt19937_64 engine(static_cast<unsigned>(random.Integer(0, 1 << 30)));
  std::normal_distribution<double> normal;
  Eigen::Matrix3Xd points(3, count);
  for (auto p : points.colwise()) {
    p = shape.At(piece.u_start + piece.u_length * random.Real(0, 1),
                 piece.v_start + piece.v_length * random.Real(0, 1));
    for (double& x : p) x += sigma * normal(engine);
  }
  return points;
}

}  // namespace batten::internal
