// SPDX-License-Identifier: MIT
// Points in order along well-known curves.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

namespace batten::internal {

// Points of t ↦ place(t) at `count` even parameters from `begin` to `end`, both included.
template <typename Place>
Eigen::Matrix3Xd AlongCurve(int count, double begin, double end, const Place& place) {
  Eigen::Matrix3Xd points(3, count);
  for (int k = 0; k < count; ++k) points.col(k) = place(begin + (end - begin) * k / (count - 1));
  return points;
}

inline Eigen::Vector3d OnCircle(double t) { return {std::cos(t), std::sin(t), 0}; }

inline Eigen::Matrix3Xd Arc(int count, double degrees) {
  return AlongCurve(count, 0, degrees * std::numbers::pi / 180, OnCircle);
}

// All the way round without the first point again.
inline Eigen::Matrix3Xd Ellipse(int count, double a, double b, double begin = 0) {
  const double turn = 2 * std::numbers::pi;
  return AlongCurve(count, begin, begin + turn * (count - 1) / count, [&](double t) {
    return Eigen::Vector3d(a * std::cos(t), b * std::sin(t), 0);
  });
}

inline Eigen::Matrix3Xd Flower(int count) {
  const double turn = 2 * std::numbers::pi;
  return AlongCurve(count, 0, turn * (count - 1) / count, [](double t) {
    return Eigen::Vector3d((1 + 0.25 * std::cos(5 * t)) * OnCircle(t));
  });
}

inline Eigen::Matrix3Xd Helix(int count) {
  return AlongCurve(count, 0, 5 * std::numbers::pi, [](double t) {
    return Eigen::Vector3d((1 + 0.3 * std::cos(2.2 * t)) * OnCircle(t) +
                           Eigen::Vector3d(0, 0, 0.08 * t));
  });
}

inline Eigen::Matrix3Xd Spiral(int count, double turns) {
  return AlongCurve(count, 0.15, turns, [](double t) {
    return Eigen::Vector3d(t * OnCircle(2 * std::numbers::pi * t));
  });
}

inline Eigen::Matrix3Xd FigureEight(int count) {
  const double turn = 2 * std::numbers::pi;
  return AlongCurve(count, 0, turn * (count - 1) / count, [](double t) {
    return Eigen::Vector3d(std::sin(t), std::sin(t) * std::cos(t), 0);
  });
}

// Straight sides between the corners with `per_side` steps each; the last corner is not repeated
// unless it is given.
inline Eigen::Matrix3Xd Polyline(const std::vector<Eigen::Vector3d>& corners, int per_side) {
  const int sides = static_cast<int>(corners.size()) - 1;
  Eigen::Matrix3Xd points(3, sides * per_side + 1);
  for (int k = 0; k <= sides * per_side; ++k) {
    const auto side = static_cast<size_t>(std::min(k / per_side, sides - 1));
    const double share = static_cast<double>(k) / per_side - static_cast<double>(side);
    points.col(k) = corners[side] + share * (corners[side + 1] - corners[side]);
  }
  return points;
}

inline Eigen::Matrix3Xd Zigzag(int teeth, int per_side, double height) {
  std::vector<Eigen::Vector3d> corners;
  for (int k = 0; k <= teeth; ++k) corners.emplace_back(k, k % 2 == 0 ? 0 : height, 0);
  return Polyline(corners, per_side);
}

// A NACA 4-digit outline of 12 % thickness and 4 % camber from the upper trailing edge around the
// nose to the lower one, points by cosine; `last` is the coefficient of x⁴: −0.1036 closes the
// trailing edge, −0.1015 leaves it blunt. [Abbott & von Doenhoff 1959, §6.4]
inline Eigen::Matrix3Xd Airfoil(int half, double last) {
  Eigen::Matrix3Xd points(3, 2 * half + 1);
  for (int k = -half; k <= half; ++k) {
    const double x = 1 - std::cos(0.5 * std::numbers::pi * std::abs(k) / half);
    const double thickness =
        0.6 * (0.2969 * std::sqrt(x) + x * (-0.1260 + x * (-0.3516 + x * (0.2843 + x * last))));
    const double camber =
        x < 0.4 ? 0.04 / 0.16 * (0.8 * x - x * x) : 0.04 / 0.36 * (0.2 + 0.8 * x - x * x);
    points.col(k + half) << x, camber + (k < 0 ? thickness : -thickness), 0;
  }
  return points;
}

class NoisyPoints {
 public:
  explicit NoisyPoints(unsigned seed) : generator_(seed) {}
  double Real(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(generator_);
  }
  int Integer(int low, int high) {
    return std::uniform_int_distribution<int>(low, high)(generator_);
  }
  double Normal() { return std::normal_distribution<double>()(generator_); }

  // Normal noise in the first `dimension` coordinates.
  Eigen::Matrix3Xd Scattered(Eigen::Matrix3Xd points, double sigma, int dimension) {
    for (Eigen::Index k = 0; k < points.cols(); ++k) {
      for (int d = 0; d < dimension; ++d) points(d, k) += sigma * Normal();
    }
    return points;
  }

  std::vector<Eigen::Index> Shuffled(Eigen::Index count) {
    std::vector<Eigen::Index> order(static_cast<size_t>(count));
    for (Eigen::Index k = 0; k < count; ++k) order[static_cast<size_t>(k)] = k;
    std::shuffle(order.begin(), order.end(), generator_);
    return order;
  }

 private:
  std::mt19937_64 generator_;
};

inline Eigen::Matrix3Xd Picked(const Eigen::Matrix3Xd& points,
                               const std::vector<Eigen::Index>& order) {
  return points(Eigen::all, order);
}

}  // namespace batten::internal
