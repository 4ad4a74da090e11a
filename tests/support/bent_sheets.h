// SPDX-License-Identifier: MIT
// Sheets that no plane sees whole, as maps of the unit square, and points scattered over them.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "jittered_shell.h"

namespace batten::internal {

struct BentSheet {
  std::string name;
  std::function<Eigen::Vector3d(double, double)> at;
  // Lengths along a developable sheet: distances in it are those along the sheet. Else empty.
  std::function<Eigen::Vector2d(double, double)> flat = {};
  std::function<bool(double, double)> inside = {};  // empty: the whole square

  bool Holds(double u, double v) const { return !inside || inside(u, v); }

  // Of length 1 on the sheet; by differences, for the direction of noise.
  Eigen::Vector3d NormalAt(double u, double v) const {
    constexpr double kStep = 1e-5;
    const Eigen::Vector3d along = at(u + kStep, v) - at(u - kStep, v);
    const Eigen::Vector3d across = at(u, v + kStep) - at(u, v - kStep);
    return along.cross(across).normalized();
  }
};

inline BentSheet FlatSheet(double length = 1, double width = 1) {
  return {"flat",
          [=](double u, double v) { return Eigen::Vector3d(length * u, width * v, 0); },
          [=](double u, double v) { return Eigen::Vector2d(length * u, width * v); }};
}

// The wavy shell of 200 degrees.
inline BentSheet ShellSheet() { return {"shell", Shell}; }

// Part of a cylinder of radius 1.
inline BentSheet ArcSheet(double degrees, double width = 1.5) {
  const double angle = degrees * std::numbers::pi / 180;
  return {"arc",
          [=](double u, double v) {
            return Eigen::Vector3d(std::cos(angle * u), std::sin(angle * u), width * v);
          },
          [=](double u, double v) { return Eigen::Vector2d(angle * u, width * v); }};
}

// Two bends, one to the left and one to the right, its heading a cosine of arc length.
inline BentSheet SBend(double degrees = 150, double length = 3, double width = 1.2) {
  const auto heading = [=](double s) {
    return degrees * std::numbers::pi / 360 * (1 - std::cos(2 * std::numbers::pi * s));
  };
  return {"s-bend",
          [=](double u, double v) {
            constexpr int kIntervals = 64;  // Simpson's rule: 1e-8 of the length
            Eigen::Vector2d place = Eigen::Vector2d::Zero();
            for (int i = 0; i <= kIntervals; ++i) {
              const double weight = i == 0 || i == kIntervals ? 1 : (i % 2 == 1 ? 4 : 2);
              const double angle = heading(u * i / kIntervals);
              place += weight * Eigen::Vector2d(std::cos(angle), std::sin(angle));
            }
            place *= length * u / (3 * kIntervals);
            return Eigen::Vector3d(place[0], width * v, place[1]);
          },
          [=](double u, double v) { return Eigen::Vector2d(length * u, width * v); }};
}

// A helicoid between two radii. [its plan covers itself from one turn on]
inline BentSheet HelicalRamp(double turns, double inner = 1, double outer = 2, double pitch = 2) {
  return {"ramp", [=](double u, double v) {
            const double angle = 2 * std::numbers::pi * turns * u,
                         radius = inner + (outer - inner) * v;
            return Eigen::Vector3d(
                radius * std::cos(angle), radius * std::sin(angle), pitch * turns * u);
          }};
}

// Part of a spiral of Archimedes whose turns are `apart`.
inline BentSheet Roll(double turns = 1.5,
                      double apart = 0.15,
                      double inner = 0.3,
                      double width = 1) {
  const double b = apart / (2 * std::numbers::pi);
  const auto along = [=](double radius) {
    return (radius * std::hypot(radius, b) + b * b * std::asinh(radius / b)) / (2 * b);
  };
  return {"roll",
          [=](double u, double v) {
            const double angle = 2 * std::numbers::pi * turns * u, radius = inner + b * angle;
            return Eigen::Vector3d(radius * std::cos(angle), radius * std::sin(angle), width * v);
          },
          [=](double u, double v) {
            return Eigen::Vector2d(along(inner + apart * turns * u) - along(inner), width * v);
          }};
}

// Part of a cone about the z axis, its radius from `narrow` to `wide`.
inline BentSheet WideningPipe(double degrees = 220,
                              double narrow = 0.4,
                              double wide = 0.8,
                              double height = 1.5) {
  const double angle = degrees * std::numbers::pi / 180;
  const double slant = std::hypot(height, wide - narrow);
  const double sine = (wide - narrow) / slant;
  return {"widening pipe",
          [=](double u, double v) {
            const double radius = narrow + (wide - narrow) * v;
            return Eigen::Vector3d(
                radius * std::cos(angle * u), radius * std::sin(angle * u), height * v);
          },
          [=](double u, double v) {
            const double from_apex = narrow / sine + slant * v;
            return Eigen::Vector2d(from_apex * std::cos(angle * sine * u),
                                   from_apex * std::sin(angle * sine * u));
          }};
}

// The part of the unit sphere up to so many degrees from its pole, equal areas to equal areas.
inline BentSheet SphericalCap(double degrees) {
  const double height = 1 - std::cos(degrees * std::numbers::pi / 180);
  return {"cap", [=](double u, double v) {
            const double z = 1 - height * u, radius = std::sqrt(std::max(0.0, 1 - z * z));
            const double angle = 2 * std::numbers::pi * v;
            return Eigen::Vector3d(radius * std::cos(angle), radius * std::sin(angle), z);
          }};
}

// A strip with a number of half twists whose ends meet: one-sided where it is odd.
inline BentSheet TwistedBand(int half_twists = 1, double width = 0.6) {
  return {"twisted band", [=](double u, double v) {
            const double angle = 2 * std::numbers::pi * u, across = width * (v - 0.5);
            const double tilt = half_twists * angle / 2, radius = 1 + across * std::cos(tilt);
            return Eigen::Vector3d(
                radius * std::cos(angle), radius * std::sin(angle), across * std::sin(tilt));
          }};
}

inline BentSheet TorusSheet(double small = 0.4) {
  return {"torus", [=](double u, double v) {
            const double a = 2 * std::numbers::pi * u, b = 2 * std::numbers::pi * v;
            const double radius = 1 + small * std::cos(b);
            return Eigen::Vector3d(radius * std::cos(a), radius * std::sin(a), small * std::sin(b));
          }};
}

// The same sheet without a part of it.
inline BentSheet LShaped(BentSheet sheet) {
  sheet.name += ", L-shaped";
  sheet.inside = [](double u, double v) { return u < 0.45 || v < 0.45; };
  return sheet;
}

inline BentSheet RingShaped(BentSheet sheet) {
  sheet.name += ", ring-shaped";
  sheet.inside = [](double u, double v) {
    const double radius = std::hypot(u - 0.5, v - 0.5);
    return radius < 0.5 && radius > 0.22;
  };
  return sheet;
}

inline BentSheet DiscShaped(BentSheet sheet) {
  sheet.name += ", disc-shaped";
  sheet.inside = [](double u, double v) { return std::hypot(u - 0.5, v - 0.5) < 0.5; };
  return sheet;
}

struct SheetScatter {
  Eigen::Index count = 5000;
  double sigma = 0;        // of the noise along the normal …
  bool isotropic = false;  // … or of each coordinate
  double density = 1;      // how many times as dense the points are at u = 0 as at u = 1
  std::uint64_t seed = 1;
};

struct SheetPoints {
  Eigen::Matrix3Xd points;
  Eigen::Matrix2Xd parameters;  // of the unit square
};

inline SheetPoints PointsOn(const BentSheet& sheet, const SheetScatter& scatter) {
  std::mt19937_64 engine(scatter.seed);
  const auto uniform = [&] { return static_cast<double>(engine() >> 11) * 0x1p-53; };
  const auto normal = [&] {
    const double radius = std::sqrt(-2 * std::log(1 - uniform()));
    return radius * std::cos(2 * std::numbers::pi * uniform());
  };
  SheetPoints result{Eigen::Matrix3Xd(3, scatter.count), Eigen::Matrix2Xd(2, scatter.count)};
  for (Eigen::Index k = 0; k < scatter.count; ++k) {
    double u, v;
    do {
      u = uniform();
      v = uniform();
      if (scatter.density != 1) {
        u = -std::log(1 - u * (1 - 1 / scatter.density)) / std::log(scatter.density);
      }
    } while (!sheet.Holds(u, v));
    result.parameters.col(k) << u, v;
    auto point = result.points.col(k);
    point = sheet.at(u, v);
    if (!(scatter.sigma > 0)) continue;
    if (scatter.isotropic) {
      for (double& x : point) x += scatter.sigma * normal();
    } else {
      point += scatter.sigma * normal() * sheet.NormalAt(u, v);
    }
  }
  return result;
}

// Noise-free points all over the sheet, about side² of them.
inline Eigen::Matrix3Xd SheetTruth(const BentSheet& sheet, int side) {
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < side; ++i) {
    for (int j = 0; j < side; ++j) {
      const double u = (i + 0.5) / side, v = (j + 0.5) / side;
      if (sheet.Holds(u, v)) points.push_back(sheet.at(u, v));
    }
  }
  return Eigen::Map<Eigen::Matrix3Xd>(
      points.data()->data(), 3, static_cast<Eigen::Index>(points.size()));
}

}  // namespace batten::internal
