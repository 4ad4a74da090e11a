// SPDX-License-Identifier: MIT
#include "fitting/regions/smooth_contact.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "fitting/regions/face_borders.h"

namespace batten::internal {
namespace {

using Eigen::Vector3d;

struct Touching {
  std::string name;
  ContactKind kind;
  FittedSurface a, b;
  Vector3d near;  // beside the curve
};

FittedSurface Torus(const Vector3d& near, const Vector3d& center, double major, double minor) {
  return TorusNear(near, center, Vector3d::UnitZ(), major, minor);
}

// Shapes about the z axis or along it that touch exactly, before they are moved anywhere.
std::vector<Touching> TouchingShapes() {
  const Vector3d z = Vector3d::UnitZ(), x = Vector3d::UnitX(), o = Vector3d::Zero();
  const auto cylinder =
      [](const Vector3d& near, const Vector3d& on, const Vector3d& axis, double radius) {
        return CylinderNear(near, on, axis, radius);
      };
  std::vector<Touching> all;
  const Vector3d floor(0.05, 0, 0.3);
  all.push_back({"plane and fillet",
                 ContactKind::kStraight,
                 PlaneAt({1, 0, 2}, Vector3d::UnitY()),
                 cylinder(floor, {0, 0.4, 0}, z, 0.4),
                 floor});
  const Vector3d side(0.51, 0.02, 0.1);
  all.push_back({"fillet beside a cylinder",
                 ContactKind::kStraight,
                 cylinder(side, o, z, 0.5),
                 cylinder(side, {0.7, 0, 0}, z, 0.2),
                 side});
  all.push_back({"fillet inside a cylinder",
                 ContactKind::kStraight,
                 cylinder(side, o, z, 0.5),
                 cylinder(side, {0.3, 0, 0}, z, 0.2),
                 side});
  const Vector3d ring(0.7, 0.05, 0.01);
  all.push_back({"plane and ring",
                 ContactKind::kRound,
                 PlaneAt(o, z),
                 Torus(ring, {0, 0, 0.2}, 0.7, 0.2),
                 ring});
  const Vector3d shaft(0.5, 0.05, 0.21);
  all.push_back({"shaft and ring",
                 ContactKind::kRound,
                 cylinder(shaft, o, z, 0.5),
                 Torus(shaft, {0, 0, 0.2}, 0.7, 0.2),
                 shaft});
  const Vector3d cap(0.4, 0.02, 0.02);
  all.push_back({"cylinder and its cap",
                 ContactKind::kRound,
                 cylinder(cap, o, z, 0.4),
                 SphereNear(cap, o, 0.4),
                 cap});
  // A cone of half angle 30° with its tip below, and a ring inside it.
  const double away = 0.1 / std::cos(std::numbers::pi / 6);
  const Vector3d tip(0, 0, -1), slope(0.55, 0.03, 0.02);
  const double wall = std::tan(std::numbers::pi / 6);
  all.push_back({"cone and ring",
                 ContactKind::kRound,
                 ConeNear(slope, tip, z, std::numbers::pi / 6),
                 Torus(slope, o, wall - away, 0.1),
                 slope});
  const Vector3d dome(0.45, 0.02, 0.6);
  all.push_back({"dome and ring",
                 ContactKind::kRound,
                 SphereNear(dome, o, 0.75),
                 Torus(dome, {0, 0, 0.52}, 0.39, 0.1),
                 dome});
  const Vector3d bend(0.85, 0.04, 0.15);
  all.push_back({"pipe and bend",
                 ContactKind::kPipe,
                 cylinder(bend, {0.8, 0, 0}, Vector3d::UnitY(), 0.15),
                 Torus(bend, o, 0.8, 0.15),
                 bend});
  all.push_back({"bend and its end",
                 ContactKind::kPipe,
                 SphereNear(bend, 0.8 * x, 0.15),
                 Torus(bend, o, 0.8, 0.15),
                 bend});
  return all;
}

FittedSurface Placed(FittedSurface shape, const Eigen::Isometry3d& by) {
  shape.point = by * shape.point;
  shape.normal = by.linear() * shape.normal;
  shape.along = by.linear() * shape.along;
  return shape;
}

TEST(SmoothContactTest, IsWhereBothShapesAreWithOneNormal) {
  constexpr double kExact = 1e-12;
  for (int turn = 0; turn < 5; ++turn) {
    Eigen::Isometry3d by = Eigen::Isometry3d::Identity();
    by.rotate(Eigen::AngleAxisd(0.7 * turn, Vector3d(1, 2, -turn).normalized()));
    by.pretranslate(Vector3d(0.3, -0.1 * turn, 0.2));
    for (const Touching& one : TouchingShapes()) {
      SCOPED_TRACE(one.name);
      const FittedSurface a = Placed(one.a, by), b = Placed(one.b, by);
      const SmoothContact contact{one.kind, by * one.near};
      for (const bool swapped : {false, true}) {
        const FittedSurface &first = swapped ? b : a, &second = swapped ? a : b;
        const auto gap = ContactGap(contact, first, second);
        ASSERT_TRUE(gap);
        EXPECT_LT(gap->norm(), kExact);
        const FittedSurface normals = NormalsAlong(contact, first, second);
        const auto place = PlaceOn({&first, &normals}, contact.near, 0.3);
        ASSERT_TRUE(place);
        EXPECT_LT(std::abs(second.Distance(*place)), kExact);
        const Vector3d here = first.TouchingNear(*place).normal,
                       there = second.TouchingNear(*place).normal;
        EXPECT_LT(here.cross(there).norm(), 1e-9);  // what is off by 1e-12 is turned by its root
        EXPECT_LT(std::abs(normals.TouchingNear(*place).normal.dot(here)), 1e-9);
      }
    }
  }
}

TEST(SmoothContactTest, TellsShapesThatMissOrCross) {
  constexpr double kOff = 1e-3;
  for (const Touching& one : TouchingShapes()) {
    SCOPED_TRACE(one.name);
    // Away along the common normal: the gap is what they are apart.
    FittedSurface moved = one.b;
    moved.point += kOff * one.a.TouchingNear(one.near).normal;
    const auto gap = ContactGap({one.kind, one.near}, one.a, moved);
    ASSERT_TRUE(gap);
    EXPECT_GT(gap->norm(), 0.3 * kOff);
    EXPECT_LT(gap->norm(), 3 * kOff);
  }
}

TEST(SmoothContactTest, IsNotOfShapesThatCannotHaveIt) {
  const Vector3d o = Vector3d::Zero(), z = Vector3d::UnitZ();
  const FittedSurface plane = PlaneAt(o, z), ball = SphereNear(z, o, 1);
  for (const ContactKind kind : kContactKinds) EXPECT_FALSE(ContactGap({kind, z}, plane, ball));
  const FittedSurface one = CylinderNear({1, 0, 0}, o, z, 1),
                      same = CylinderNear({1, 0, 0}, {0.01, 0, 0}, z, 1);
  EXPECT_FALSE(ContactGap({ContactKind::kStraight, {1, 0, 0}}, one, same));
}

}  // namespace
}  // namespace batten::internal
