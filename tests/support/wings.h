// SPDX-License-Identifier: MIT
// Closed wings given by formulas: sections with a round nose and a sharp trailing edge, tapered,
// swept, twisted and cambered, open at both tips.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <memory>
#include <numbers>
#include <random>
#include <vector>

namespace batten::internal {

struct WingShape {
  double thickness = 0.12;  // of the chord
  double camber = 0.02;     // of the chord, at 0.4 of it
  double span = 2.5;        // in chords of the root
  double taper = 0.5;       // chord of the tip over that of the root
  double sweep = 0.3;       // way of the tip's nose downstream
  double twist = 0;         // of the tip, radians
  double dihedral = 0.1;    // height of the tip
  double fullness = 1;      // of the section towards the edge: 1 as the four-digit series
};

// The section of a wing of chord 1, nose at 0 and edge at (1, 0), by a place s in 0 … 1 from the
// edge over the upper side, round the nose and back to the edge, as lengths of the section.
// [four-digit series: Jacobs, Ward & Pinkerton 1933, closed at the edge]
class WingSection {
 public:
  explicit WingSection(const WingShape& shape) : shape_(shape) {
    lengths_.push_back(0);
    for (int k = 1; k <= kChords; ++k)
      lengths_.push_back(lengths_.back() + (At(RootOf(k)) - At(RootOf(k - 1))).norm());
  }

  double length() const { return lengths_.back(); }

  // The place at s; cubic between the table's lengths, so that it is smooth in s to rounding.
  Eigen::Vector2d Place(double s) const {
    const double way = std::clamp(s, 0.0, 1.0) * length();
    const auto next = std::upper_bound(lengths_.begin() + 1, lengths_.end() - 1, way);
    const auto k = static_cast<int>(next - lengths_.begin()) - 1;
    const auto at = [&](int i) { return lengths_[static_cast<size_t>(i)]; };
    const double share = (way - at(k)) / (at(k + 1) - at(k));
    return At(RootOf(k + share));
  }

  // tan of half the angle at the edge.
  double HalfSlope() const {
    const Eigen::Vector2d a = At(1), b = At(1 - 1e-4), c = At(1e-4 - 1);
    return (b - c).norm() / 2 / (a - (b + c) / 2).norm();
  }

 private:
  static constexpr int kChords = 4000;
  static double RootOf(double k) { return 1 - 2 * k / kChords; }

  // By the signed root of the place along the chord, 1 at the edge of the upper side.
  Eigen::Vector2d At(double root) const {
    const double r = std::abs(root), x = r * r, side = root < 0 ? -1 : 1;
    const double closing = 0.2969 - 0.126 - 0.3516 + 0.2843;
    const double half =
        5 * shape_.thickness *
        (0.2969 * r - 0.126 * x - 0.3516 * x * x + 0.2843 * x * x * x - closing * x * x * x * x) *
        (1 + (shape_.fullness - 1) * x);
    constexpr double kCrest = 0.4;
    const double mean = x < kCrest ? shape_.camber / (kCrest * kCrest) * x * (2 * kCrest - x)
                                   : shape_.camber / ((1 - kCrest) * (1 - kCrest)) *
                                         (1 - 2 * kCrest + x * (2 * kCrest - x));
    return {x, mean + side * half};
  }

  WingShape shape_;
  std::vector<double> lengths_;
};

// u from the edge round the nose to the edge, v from root to tip, in the unit square.
using WingMap = std::function<Eigen::Vector3d(double, double)>;

inline WingMap MapOf(const WingShape& shape) {
  const auto section = std::make_shared<const WingSection>(shape);
  return [=](double u, double v) {
    const double chord = 1 - (1 - shape.taper) * v, angle = shape.twist * v;
    const Eigen::Vector2d place = section->Place(u) - Eigen::Vector2d(0.25, 0);
    const double x = chord * (std::cos(angle) * place[0] + std::sin(angle) * place[1]),
                 y = chord * (-std::sin(angle) * place[0] + std::cos(angle) * place[1]);
    return Eigen::Vector3d(0.25 + x + shape.sweep * v, shape.span * v, y + shape.dihedral * v * v);
  };
}

// A section both of whose ends are round: an ellipse, tapered as a wing.
inline WingMap EllipticTube(double thickness, double span) {
  return [=](double u, double v) {
    const double angle = 2 * std::numbers::pi * u, chord = 1 - 0.4 * v;
    return Eigen::Vector3d(
        chord * std::cos(angle) / 2, span * v, chord * thickness * std::sin(angle) / 2);
  };
}

// Points spread evenly over a map's area, with noise in every coordinate.
struct WingCloud {
  Eigen::Matrix3Xd points;
  Eigen::Matrix2Xd at;  // (u, v)
};

inline WingCloud PointsOverWing(const WingMap& map,
                                Eigen::Index count,
                                double sigma,
                                std::uint64_t seed) {
  std::mt19937_64 engine(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::normal_distribution<double> normal(0, sigma);
  const auto stretch = [&](double u, double v) {
    constexpr double kStep = 1e-4;
    const double low = std::max(0.0, u - kStep), high = std::min(1.0, u + kStep);
    return ((map(high, v) - map(low, v)) / (high - low))
        .cross((map(u, v + kStep) - map(u, v - kStep)) / (2 * kStep))
        .norm();
  };
  double most = 0;
  for (int i = 0; i <= 60; ++i)
    for (int j = 0; j <= 10; ++j) most = std::max(most, 1.1 * stretch(i / 60.0, j / 10.0));
  WingCloud cloud{Eigen::Matrix3Xd(3, count), Eigen::Matrix2Xd(2, count)};
  for (Eigen::Index k = 0; k < count;) {
    const double u = uniform(engine), v = uniform(engine);
    if (uniform(engine) * most > stretch(u, v)) continue;
    cloud.points.col(k) = map(u, v);
    for (double& x : cloud.points.col(k)) x += normal(engine);
    cloud.at.col(k++) << u, v;
  }
  return cloud;
}

}  // namespace batten::internal
