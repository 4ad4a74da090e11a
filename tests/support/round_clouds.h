// SPDX-License-Identifier: MIT
// Shapes of revolution, whole and in part, and points scattered over them, turned in space.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <string>
#include <utility>
#include <vector>

namespace batten::internal::round_clouds {

// About the z axis: angle in [0, turn], place (r, z) of the profile at t in [0, 1].
struct RoundThing {
  std::string name;
  std::function<Eigen::Vector2d(double)> profile;
  double turn = 2 * std::numbers::pi;
  bool closed_profile = false, pole_start = false, pole_end = false;  // as t grows
  // Added to the radius, by angle and t.
  std::function<double(double, double)> ripple = {};

  bool closed_round() const { return turn >= 2 * std::numbers::pi; }

  Eigen::Vector3d At(double angle, double t) const {
    const Eigen::Vector2d place = profile(t);
    const double r = place[0] + (ripple ? ripple(angle, t) : 0);
    return {r * std::cos(angle), r * std::sin(angle), place[1]};
  }

  // Length of the mean profile from 0 to t.
  double LengthTo(double t) const {
    constexpr int kSteps = 400;
    double sum = 0;
    for (int i = 0; i < kSteps; ++i) {
      sum += (profile(t * (i + 1) / kSteps) - profile(t * i / kSteps)).norm();
    }
    return sum;
  }

  RoundThing Part(double degrees) const {
    RoundThing part = *this;
    part.turn = degrees * std::numbers::pi / 180;
    part.name += " of " + std::to_string(std::lround(degrees)) + " degrees";
    return part;
  }
};

inline RoundThing Can(double radius = 0.5, double height = 1) {
  return {"cylinder", [=](double t) { return Eigen::Vector2d(radius, height * (t - 0.5)); }};
}

// Half angle in degrees, radii of its ends; a pole where the first is 0.
inline RoundThing Cone(double degrees = 20, double narrow = 0.2, double wide = 0.6) {
  const double slope = std::tan(degrees * std::numbers::pi / 180);
  RoundThing cone{"cone", [=](double t) {
                    const double r = narrow + (wide - narrow) * t;
                    return Eigen::Vector2d(r, r / slope);
                  }};
  cone.pole_start = narrow == 0;
  if (cone.pole_start) cone.name = "cone with its apex";
  return cone;
}

inline RoundThing Vase(double ripple = 0.1) {
  using std::numbers::pi;
  RoundThing vase{"vase", [](double t) {
                    return Eigen::Vector2d(0.4 + 0.12 * std::sin(5 * t + 0.5), 1.2 * t);
                  }};
  if (ripple > 0) {
    vase.name = "vase with ripples";
    vase.ripple = [=](double angle, double t) {
      return 0.4 * ripple * std::cos(6 * angle) * std::sin(3 * pi * t);
    };
  }
  return vase;
}

inline RoundThing Ball(double radius = 1) {
  return {"sphere",
          [=](double t) {
            const double a = std::numbers::pi * t;
            return Eigen::Vector2d(radius * std::sin(a), -radius * std::cos(a));
          },
          2 * std::numbers::pi,
          false,
          true,
          true};
}

// The part of a sphere from one polar angle to another, in degrees.
inline RoundThing Zone(double from, double to) {
  return {"zone",
          [=](double t) {
            const double a = (from + (to - from) * t) * std::numbers::pi / 180;
            return Eigen::Vector2d(std::sin(a), -std::cos(a));
          },
          2 * std::numbers::pi,
          false,
          from == 0,
          to == 180};
}

inline RoundThing Egg() {
  return {"egg",
          [](double t) {
            const double a = std::numbers::pi * t;
            return Eigen::Vector2d(0.7 * std::sin(a) * (1 + 0.2 * std::cos(a)), -std::cos(a));
          },
          2 * std::numbers::pi,
          false,
          true,
          true};
}

inline RoundThing Tyre(double radius = 1, double tube = 0.35) {
  return {"torus",
          [=](double t) {
            const double a = 2 * std::numbers::pi * t;
            return Eigen::Vector2d(radius + tube * std::cos(a), tube * std::sin(a));
          },
          2 * std::numbers::pi,
          true};
}

// A ring whose section is a rounded rectangle, bent in on one side.
inline RoundThing Washer() {
  return {"ring",
          [](double t) {
            const double a = 2 * std::numbers::pi * t, c = std::cos(a), s = std::sin(a);
            const double radius = 0.3 / std::pow(c * c * c * c + s * s * s * s, 0.25);
            return Eigen::Vector2d(1 + 0.7 * radius * c - 0.08 * s * s, 1.5 * radius * s);
          },
          2 * std::numbers::pi,
          true};
}

// A flat bottom, a rim of the given radius, a wall.
inline RoundThing Cup(double rim = 0.12) {
  constexpr double kRadius = 0.5, kHeight = 1;
  const double bottom = kRadius - rim, arc = rim * std::numbers::pi / 2, wall = kHeight - rim;
  return {"cup",
          [=](double t) {
            const double s = t * (bottom + arc + wall);
            if (s < bottom) return Eigen::Vector2d(s, 0);
            if (s < bottom + arc) {
              const double a = (s - bottom) / std::max(rim, 1e-300);
              return Eigen::Vector2d(bottom + rim * std::sin(a), rim * (1 - std::cos(a)));
            }
            return Eigen::Vector2d(kRadius, rim + s - bottom - arc);
          },
          2 * std::numbers::pi,
          false,
          true,
          false};
}

struct RoundScatter {
  Eigen::Index count = 10000;
  double sigma = 0;    // of every coordinate
  double density = 1;  // the first end against the last
  double far = 0;      // how far away the cloud is put
  double unit = 1;
  bool turned = true;
  unsigned seed = 1;
  // Empty: everything.
  std::function<bool(double, double)> inside = {};
};

struct RoundPoints {
  Eigen::Matrix3Xd points;
  Eigen::Matrix2Xd truth;  // angle and t
  Eigen::Matrix3Xd clean;  // points without noise
};

// Even over the area, but for the density asked for.
inline RoundPoints PointsOn(const RoundThing& thing, const RoundScatter& scatter) {
  std::mt19937_64 engine(scatter.seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::normal_distribution<double> normal(0, 1);
  const auto area = [&](double t) {
    constexpr double kStep = 1e-5;
    const double a = std::max(0.0, t - kStep), b = std::min(1.0, t + kStep);
    return thing.profile(t)[0] * (thing.profile(b) - thing.profile(a)).norm() / (b - a) *
           std::pow(scatter.density, -t);
  };
  double most = 0;
  for (int i = 0; i <= 1000; ++i) most = std::max(most, 1.01 * area(i / 1000.0));
  Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();
  Eigen::Vector3d away = Eigen::Vector3d::Zero();
  if (scatter.turned) {
    turn = Eigen::Quaterniond(normal(engine), normal(engine), normal(engine), normal(engine));
    turn.normalize();
    away = scatter.far * Eigen::Vector3d(1, -0.7, 0.4);
  }
  RoundPoints cloud{Eigen::Matrix3Xd(3, scatter.count),
                    Eigen::Matrix2Xd(2, scatter.count),
                    Eigen::Matrix3Xd(3, scatter.count)};
  for (Eigen::Index k = 0; k < scatter.count;) {
    const double angle = thing.turn * uniform(engine), t = uniform(engine);
    if (uniform(engine) * most > area(t)) continue;
    if (scatter.inside && !scatter.inside(angle, t)) continue;
    cloud.truth.col(k) << angle, t;
    const Eigen::Vector3d p = turn * thing.At(angle, t) + away;
    const Eigen::Vector3d noise(normal(engine), normal(engine), normal(engine));
    cloud.clean.col(k) = scatter.unit * p;
    cloud.points.col(k) = scatter.unit * (p + scatter.sigma * noise);
    ++k;
  }
  return cloud;
}

}  // namespace batten::internal::round_clouds
