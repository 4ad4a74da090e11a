// SPDX-License-Identifier: MIT
// Bent pipes and what is like them, as maps of the unit square: u once round, v along.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>

#include "bent_sheets.h"

namespace batten::internal {

// Part of a torus: a round pipe bent in a circle.
inline BentSheet Elbow(double degrees, double bend = 2.5, double radius = 1) {
  const double sweep = degrees * std::numbers::pi / 180;
  return {"elbow of " + std::to_string(static_cast<int>(degrees)), [=](double u, double v) {
            const double a = 2 * std::numbers::pi * u, from_axis = bend + radius * std::cos(a);
            return Eigen::Vector3d(from_axis * std::cos(sweep * v),
                                   from_axis * std::sin(sweep * v),
                                   radius * std::sin(a));
          }};
}

// A cone, or a cylinder where both radii are one.
inline BentSheet StraightTube(double length, double from = 1, double to = 1) {
  return {"straight tube", [=](double u, double v) {
            const double a = 2 * std::numbers::pi * u, radius = from + (to - from) * v;
            return Eigen::Vector3d(radius * std::cos(a), radius * std::sin(a), length * v);
          }};
}

// About a curve c(v), its section r(u, v) times a unit circle whose axis is held as upright as can
// be: the curve is never vertical.
inline BentSheet TubeAbout(std::string name,
                           std::function<Eigen::Vector3d(double)> centre,
                           std::function<double(double, double)> radius,
                           double flatness = 1) {
  return {std::move(name), [=](double u, double v) {
            constexpr double kStep = 1e-4;
            const Eigen::Vector3d along = (centre(v + kStep) - centre(v - kStep)).normalized();
            const Eigen::Vector3d side = along.cross(Eigen::Vector3d::UnitZ()).normalized();
            const Eigen::Vector3d up = side.cross(along);
            const double a = 2 * std::numbers::pi * u, r = radius(u, v);
            return Eigen::Vector3d(centre(v) + r * std::cos(a) * side +
                                   r * flatness * std::sin(a) * up);
          }};
}

// Turns of a spring.
inline BentSheet Coil(double turns, double bend = 3.5, double rise = 2.6, double radius = 1) {
  return TubeAbout(
      "coil",
      [=](double v) {
        const double a = 2 * std::numbers::pi * turns * v;
        return Eigen::Vector3d(bend * std::cos(a), bend * std::sin(a), rise * turns * v);
      },
      [=](double, double) { return radius; });
}

// Bends left and right in two planes.
inline BentSheet Hose(double length = 12, double radius = 1) {
  return TubeAbout(
      "hose",
      [=](double v) {
        return Eigen::Vector3d(length * v, 1.8 * std::sin(5 * v), 1.2 * std::cos(4 * v));
      },
      [=](double, double) { return radius; });
}

// An S-bend whose section widens and is no circle.
inline BentSheet Horn() {
  return TubeAbout(
      "horn",
      [=](double v) { return Eigen::Vector3d(7 * v, 1.5 * std::sin(3 * v), 0); },
      [=](double u, double v) {
        return (0.6 + 0.9 * v * v) * (1 + 0.06 * std::cos(6 * std::numbers::pi * u));
      },
      0.7);
}

}  // namespace batten::internal
