// SPDX-License-Identifier: MIT
// Shapes that go all round: curves turned about an axis, wholly or in part, points scattered evenly
// over them, and how far places are from them.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <utility>

namespace batten::internal {

// The profile, turned about the z axis by u in [0, angle].
struct TurnedShape {
  std::string name;
  // The distance from the axis and the height at v in [0, length], which is near arc length. Smooth
  // beyond the ends too.
  std::function<Eigen::Vector2d(double)> profile;
  double length = 1;
  double angle = 2 * std::numbers::pi;
  bool profile_closed = false;
  bool pole_start = false,
       pole_end = false;  // the profile begins, ends at right angles to the axis

  bool turned_all_round() const { return angle >= 2 * std::numbers::pi; }
  int closed_directions() const { return int{turned_all_round()} + int{profile_closed}; }
  int poles() const { return int{pole_start} + int{pole_end}; }

  Eigen::Vector3d At(double u, double v) const {
    const Eigen::Vector2d p = profile(v);
    return {p[0] * std::cos(u), p[0] * std::sin(u), p[1]};
  }

  Eigen::Vector2d TangentAt(double v) const {  // of the profile, by differences
    const double step = 1e-5 * length;
    return (profile(v + step) - profile(v - step)) / (2 * step);
  }

  // Of length 1, to the right of the profile.
  Eigen::Vector3d NormalAt(double u, double v) const {
    const Eigen::Vector2d along = TangentAt(v).normalized();
    return {along[1] * std::cos(u), along[1] * std::sin(u), -along[0]};
  }

  // |S_u × S_v|
  double AreaAt(double v) const { return std::abs(profile(v)[0]) * TangentAt(v).norm(); }

  double Area() const {
    constexpr int kParts = 1000;
    double sum = 0;
    for (int i = 0; i < kParts; ++i) sum += AreaAt((i + 0.5) / kParts * length);
    return sum / kParts * length * angle;
  }

  double SpacingOf(Eigen::Index count) const {
    return std::sqrt(Area() / static_cast<double>(count));
  }

  // The largest extent of its box.
  double Size() const {
    constexpr int kSide = 100;
    Eigen::Array3d low = Eigen::Array3d::Constant(std::numeric_limits<double>::infinity());
    Eigen::Array3d high = -low;
    for (int i = 0; i <= kSide; ++i) {
      for (int j = 0; j <= kSide; ++j) {
        const Eigen::Vector3d p = At(angle * i / kSide, length * j / kSide);
        low = low.min(p.array());
        high = high.max(p.array());
      }
    }
    return (high - low).maxCoeff();
  }

  // Whether a place is farther than `strip` from every open border.
  bool Inside(double u, double v, double strip) const {
    const double to_side = std::min(u, angle - u) * profile(v)[0];
    if (!turned_all_round() && to_side < strip) return false;
    if (profile_closed) return true;
    return (pole_start || v >= strip) && (pole_end || length - v >= strip);
  }
};

inline TurnedShape CylinderShapeOf(double height = 3) {
  return {.name = "cylinder",
          .profile = [](double v) { return Eigen::Vector2d(1, v); },
          .length = height};
}

// Its half angle is 20 degrees; the apex is far outside.
inline TurnedShape SteepCone() {
  const double half = std::numbers::pi / 9;
  return {.name = "cone of 20 degrees",
          .profile = [=](double v) -> Eigen::Vector2d {
            return (1.5 + v) * Eigen::Vector2d(std::sin(half), std::cos(half));
          },
          .length = 3};
}

inline TurnedShape RippledVase() {
  return {.name = "vase",
          .profile =
              [](double v) {
                const double wide = 0.8 + 0.25 * std::sin(2 * std::numbers::pi * v / 3);
                return Eigen::Vector2d(wide + 0.03 * std::sin(11 * v), v);
              },
          .length = 3};
}

inline TurnedShape TorusShapeOf(double major = 2, double minor = 0.7) {
  return {.name = "torus",
          .profile = [=](double v) -> Eigen::Vector2d {
            return Eigen::Vector2d(major, 0) +
                   minor * Eigen::Vector2d(std::cos(v / minor), std::sin(v / minor));
          },
          .length = 2 * std::numbers::pi* minor,
          .profile_closed = true};
}

// A ring whose section is not round.
inline TurnedShape OvalRing() {
  constexpr double kMean = 0.6;
  return {.name = "oval ring",
          .profile = [](double v) -> Eigen::Vector2d {
            const double a = v / kMean;
            const double radius = kMean * (1 + 0.15 * std::cos(2 * a + 0.4));
            return Eigen::Vector2d(2, 0) + radius * Eigen::Vector2d(std::cos(a), std::sin(a));
          },
          .length = 2 * std::numbers::pi* kMean,
          .profile_closed = true};
}

inline TurnedShape WholeSphere() {
  return {.name = "sphere",
          .profile = [](double v) { return Eigen::Vector2d(std::sin(v), -std::cos(v)); },
          .length = std::numbers::pi,
          .pole_start = true,
          .pole_end = true};
}

// Blunt at one end.
inline TurnedShape Egg() {
  return {.name = "egg",
          .profile =
              [](double v) {
                return Eigen::Vector2d(std::sin(v) * (0.8 + 0.15 * std::cos(v)),
                                       -1.2 * std::cos(v));
              },
          .length = std::numbers::pi,
          .pole_start = true,
          .pole_end = true};
}

// Flat at the bottom and ever steeper: its slope is the hyperbolic sine of arc length.
inline TurnedShape Cup() {
  return {.name = "cup",
          .profile =
              [](double v) {
                return Eigen::Vector2d(2 * std::atan(std::tanh(v / 2)), std::log(std::cosh(v)));
              },
          .length = 3,
          .pole_start = true};
}

// A bent pipe of radius 1: part of a torus, closed round the pipe only.
inline TurnedShape PipeElbow(double degrees, double bend = 2.5) {
  TurnedShape shape = TorusShapeOf(bend, 1);
  shape.name = "elbow of " + std::to_string(static_cast<int>(degrees)) + " degrees";
  shape.angle = degrees * std::numbers::pi / 180;
  return shape;
}

// So much of the turn.
inline TurnedShape PieceOf(TurnedShape shape, double degrees = 270) {
  shape.name += ", " + std::to_string(static_cast<int>(degrees)) + " degrees of it";
  shape.angle = degrees * std::numbers::pi / 180;
  return shape;
}

struct TurnedPoints {
  Eigen::Matrix3Xd points;
  Eigen::Matrix2Xd parameters;  // the true u and v
};

// Evenly over the area, `sigma` the standard deviation of the noise in every coordinate.
inline TurnedPoints PointsOn(const TurnedShape& shape,
                             Eigen::Index count,
                             double sigma,
                             std::uint64_t seed) {
  std::mt19937_64 engine(seed);
  const auto uniform = [&] { return static_cast<double>(engine() >> 11) * 0x1p-53; };
  const auto normal = [&] {
    const double radius = std::sqrt(-2 * std::log(1 - uniform()));
    return radius * std::cos(2 * std::numbers::pi * uniform());
  };
  double most = 0;
  for (int i = 0; i <= 1000; ++i) most = std::max(most, shape.AreaAt(i / 1e3 * shape.length));
  TurnedPoints result{Eigen::Matrix3Xd(3, count), Eigen::Matrix2Xd(2, count)};
  for (Eigen::Index k = 0; k < count; ++k) {
    double v;
    do {
      v = uniform() * shape.length;
    } while (uniform() * 1.001 * most > shape.AreaAt(v));
    const double u = uniform() * shape.angle;
    result.parameters.col(k) << u, v;
    result.points.col(k) = shape.At(u, v);
    if (!(sigma > 0)) continue;
    for (double& x : result.points.col(k)) x += sigma * normal();
  }
  return result;
}

// Noise-free places evenly over the area, farther than `strip` from open borders.
inline TurnedPoints TruthOn(const TurnedShape& shape, Eigen::Index count, double strip) {
  TurnedPoints all = PointsOn(shape, count, 0, 4242);
  Eigen::Index kept = 0;
  for (Eigen::Index k = 0; k < count; ++k) {
    if (!shape.Inside(all.parameters(0, k), all.parameters(1, k), strip)) continue;
    all.points.col(kept) = all.points.col(k);
    all.parameters.col(kept++) = all.parameters.col(k);
  }
  all.points.conservativeResize(3, kept);
  all.parameters.conservativeResize(2, kept);
  return all;
}

// So many more points, evenly in the box of the others.
inline Eigen::Matrix3Xd WithOutliersInBox(const Eigen::Matrix3Xd& points,
                                          Eigen::Index more,
                                          std::uint64_t seed) {
  std::mt19937_64 engine(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  const Eigen::Vector3d low = points.rowwise().minCoeff(), high = points.rowwise().maxCoeff();
  Eigen::Matrix3Xd all(3, points.cols() + more);
  all.leftCols(points.cols()) = points;
  for (Eigen::Index k = points.cols(); k < all.cols(); ++k) {
    for (int d = 0; d < 3; ++d) all(d, k) = low[d] + (high[d] - low[d]) * uniform(engine);
  }
  return all;
}

// Where a place in space has its foot on the shape, which goes on beyond its borders.
struct TurnedFoot {
  double distance, u, v;
};

// By the nearest of many places of the profile and Newton's method from there.
inline TurnedFoot FootOn(const TurnedShape& shape, const Eigen::Vector3d& p) {
  constexpr int kPlaces = 400, kRounds = 8;
  const double beyond = shape.profile_closed ? 0 : 0.1 * shape.length;
  const double low = shape.pole_start ? 0 : -beyond;
  const double high = shape.length + (shape.pole_end ? 0 : beyond);
  const Eigen::Vector2d place(p.head<2>().norm(), p[2]);
  const auto square = [&](double v) { return (shape.profile(v) - place).squaredNorm(); };
  double v = low;
  for (int i = 1; i <= kPlaces; ++i) {
    const double other = low + (high - low) * i / kPlaces;
    if (square(other) < square(v)) v = other;
  }
  const double step = 1e-4 * shape.length;
  for (int round = 0; round < kRounds; ++round) {
    const double left = square(v - step), here = square(v), right = square(v + step);
    const double bend = left - 2 * here + right;
    if (!(bend > 0)) break;
    v = std::clamp(v - step * (right - left) / (2 * bend), low, high);
  }
  double u = std::atan2(p[1], p[0]);
  if (u < 0) u += 2 * std::numbers::pi;
  return {std::sqrt(square(v)), u, v};
}

}  // namespace batten::internal
