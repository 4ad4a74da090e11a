// SPDX-License-Identifier: MIT
// A sector of a turned disc with a stepped hole, as aero engines have them: every kind of exact
// face, and edges that fade out where three faces touch one another. Its numbers are those of the
// common test mesh "fandisk", read off its vertices by hand.
#pragma once

#include "part_clouds.h"

namespace batten::internal {

// What is inside, about the x axis: angles from 0 to ten degrees, x up to kEnd, radii between two
// profiles, less a step below and a hole across.
class SectorPart {
 public:
  static constexpr double kEnd = 4.8279, kDrum = 15.435, kRound = 0.75;

  static bool Inside(const Eigen::Vector3d& p) {
    const double r = p.tail<2>().norm();
    const bool sector = p[2] < 0 && Toe().dot(p) > 0 && p[0] > 0 && p[0] < kEnd;
    return sector && r > Lower(p[0]) && r < Upper(p[0]) && !InHole(p) && !Below(p);
  }

  // The direction of ten degrees, of the hole; across it the face at ten degrees; that of the step.
  static Eigen::Vector3d Way() { return {0, std::cos(kAngle), -std::sin(kAngle)}; }
  static Eigen::Vector3d Toe() { return {0, std::sin(kAngle), std::cos(kAngle)}; }
  static Eigen::Vector3d Step() { return {0, std::sin(kAngle), -std::cos(kAngle)}; }
  static Eigen::Vector3d Rise() { return {0, std::cos(kAngle), std::sin(kAngle)}; }
  static Eigen::Vector3d RoundMiddle() {
    constexpr double kAt = 0.095689;  // radians
    return (kDrum + kRound) * Eigen::Vector3d(0, std::cos(kAt), -std::sin(kAt));
  }

  static TruthPart Part() {
    constexpr double kHalf = kTurn / 2, kQuarter = kTurn / 4;
    TruthPart part{"sector with a stepped hole", {}, 68, 45, 0};
    part.faces = {
        Bounded(FlatFace({0, 12, 0}, {0, 6, 0}, {kEnd, 0, 0})),
        Bounded(FlatFace(12 * Way(), {kEnd, 0, 0}, 6 * Way())),
        Across(0),
        Across(1.328),
        Across(2.428),
        Across(kEnd),
        HoleStep(14.3),
        HoleStep(15.125),
        HoleStep(kDrum),
        Bounded(FlatFace(RoundMiddle() - kRound * Step() - 4 * Rise(), {kEnd, 0, 0}, 8 * Rise())),
        Round(14.685, 14.685, 0, 0.328),
        Round(12.8, 12.8, 1.578, 2.178),
        Round(kDrum, kDrum, 0, kEnd),
        Bounded(TurnedFace(RoundMiddle(), Axis(), Up(), {kRound, kRound}, {0, kEnd}, {0, kTurn})),
        Hole(2.125, 13, 14.3),
        Hole(1.6415, 14.3, 15.125),
        Hole(2.129, 15.125, kDrum),
        Hole(2.5564, kDrum, 18),
        Rolled(0.328, 13.685, 1, 0, kQuarter),
        Rolled(1.578, 13.05, 0.25, kHalf, kHalf + kQuarter),
        Rolled(2.178, 13.05, 0.25, kQuarter, kHalf),
        Rolled(0, 17.935, 2.5, kHalf - kLean, kHalf),
        Rolled(kEnd, 14.35, 3.5, -kLean, 0),
        Round(Concave()[1], Convex()[1], Concave()[0], Convex()[0]),
        Bounded(BallFace({kEnd, 0, 0},
                         Axis(),
                         Up(),
                         13.612,
                         {-kAngle, 0},
                         {-std::asin((kEnd - 2.428) / 13.612), 0}))};
    return part;
  }

 private:
  static constexpr double kAngle = kTurn / 36;

  // A cylinder, cone or torus from angle 0 to ten degrees.
  static TruthFace Round(double r0, double r1, double x0, double x1) {
    return Bounded(TurnedFace({0, 0, 0}, Axis(), Up(), {r0, r1}, {x0, x1}, {-kAngle, 0}));
  }
  static TruthFace Rolled(double x, double major, double minor, double from, double to) {
    return Bounded(RingFace({x, 0, 0}, Axis(), Up(), major, minor, {-kAngle, 0}, {from, to}));
  }
  static TruthFace Across(double x) { return Bounded(FlatFace({x, 12, 0}, {0, 6, 0}, {0, 0, -4})); }
  static TruthFace Hole(double radius, double low, double high) {
    return Bounded(
        TurnedFace({kEnd, 0, 0}, Way(), Axis(), {radius, radius}, {low, high}, {0, kTurn}));
  }
  static TruthFace HoleStep(double high) {
    return Bounded(FlatFace(high * Way(), {kEnd, 0, 0}, 4 * Toe()));
  }

  static Eigen::Vector3d Axis() { return Eigen::Vector3d::UnitX(); }
  static Eigen::Vector3d Up() { return Eigen::Vector3d::UnitY(); }

  static Eigen::Vector3d NormalAt(const SurfaceShape& shape, const Eigen::Vector3d& p) {
    if (const auto* plane = std::get_if<PlaneShape>(&shape)) return plane->normal;
    if (const auto* sphere = std::get_if<SphereShape>(&shape))
      return (p - sphere->center).normalized();
    const auto out = [&p](const Eigen::Vector3d& foot, const Eigen::Vector3d& axis) {
      return (p - foot - (p - foot).dot(axis) * axis).normalized().eval();
    };
    if (const auto* round = std::get_if<CylinderShape>(&shape))
      return out(round->point, round->axis);
    if (const auto* cone = std::get_if<ConeShape>(&shape)) {
      return std::cos(cone->half_angle) * out(cone->apex, cone->axis) -
             std::sin(cone->half_angle) * cone->axis;
    }
    const auto& torus = std::get<TorusShape>(shape);
    return (p - torus.center - torus.major_radius * out(torus.center, torus.axis)).normalized();
  }

  // What of it bounds the part.
  static TruthFace Bounded(TruthFace face) {
    face.keep = [shape = face.shape](const Eigen::Vector3d& p) {
      constexpr double kAside = 1e-7;
      const Eigen::Vector3d aside = kAside * NormalAt(shape, p);
      return Inside(p + aside) != Inside(p - aside);
    };
    return face;
  }

  // The upper profile: circles of radius 2.5 and 3.5 about (0, 17.935) and (kEnd, 14.35), and the
  // line that leans against both.
  static inline const double kLean =
      std::atan2(kEnd, 17.935 - 14.35) - std::acos(6 / std::hypot(kEnd, 17.935 - 14.35));
  static Eigen::Vector2d Concave() {
    return {2.5 * std::sin(kLean), 17.935 - 2.5 * std::cos(kLean)};
  }
  static Eigen::Vector2d Convex() {
    return {kEnd - 3.5 * std::sin(kLean), 14.35 + 3.5 * std::cos(kLean)};
  }

  static double Upper(double x) {
    if (x < Concave()[0]) return 17.935 - std::sqrt(2.5 * 2.5 - x * x);
    if (x > Convex()[0]) return 14.35 + std::sqrt(3.5 * 3.5 - (kEnd - x) * (kEnd - x));
    return Concave()[1] + (x - Concave()[0]) * std::tan(kLean);
  }

  static double Lower(double x) {
    const auto arc = [x](double at, double high, double radius) {
      return high + std::copysign(std::sqrt(radius * radius - (x - at) * (x - at)), radius);
    };
    if (x < 0.328) return 14.685;
    if (x < 1.328) return arc(0.328, 13.685, 1);
    if (x < 1.578) return arc(1.578, 13.05, -0.25);
    if (x < 2.178) return 12.8;
    if (x < 2.428) return arc(2.178, 13.05, -0.25);
    return arc(kEnd, 0, 13.612);
  }

  static bool InHole(const Eigen::Vector3d& p) {
    const double high = Way().dot(p);
    const double radius = high < 14.3     ? 2.125
                          : high < 15.125 ? 1.6415
                          : high < kDrum  ? 2.129
                                          : 2.5564;
    return (p - Eigen::Vector3d(kEnd, 0, 0)).cross(Way()).norm() < radius;
  }

  // Beyond the drum and below the step, whose corner is round.
  static bool Below(const Eigen::Vector3d& p) {
    const Eigen::Vector3d c = RoundMiddle(), flat(0, p[1], p[2]), off = flat - c;
    if (!(flat.norm() > kDrum && Step().dot(flat) > Step().dot(c) - kRound)) return false;
    const Eigen::Vector3d x = Eigen::Vector3d::UnitX();
    const bool corner = off.cross(-c).dot(x) > 0 && off.cross(-Step()).dot(x) < 0;
    return !corner || off.norm() < kRound;
  }
};

}  // namespace batten::internal
