// SPDX-License-Identifier: MIT
// Curves, patches and functions that the tables of optimisation are about.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <numbers>
#include <random>

#include "batten/geometry/nurbs_surface.h"

namespace batten::internal {

inline double Uniform(std::mt19937_64& engine) {
  return std::uniform_real_distribution<double>(0, 1)(engine);
}

inline Eigen::VectorXd Noise(std::mt19937_64& engine, int dimension, double sigma) {
  std::normal_distribution<double> normal(0, 1);
  Eigen::VectorXd result(dimension);
  for (double& x : result) x = sigma * normal(engine);
  return result;
}

// Curves over [0, 1].
inline Eigen::VectorXd Flower(double t) {
  const double a = 2 * std::numbers::pi * t,
               radius = 1 + 0.25 * std::cos(5 * a) + 0.1 * std::sin(2 * a);
  return Eigen::Vector2d(radius * std::cos(a), radius * std::sin(a));
}

inline Eigen::VectorXd Wave(double t) {
  return Eigen::Vector2d(
      6 * t, std::sin(4 * std::numbers::pi * t) + 0.3 * std::sin(14 * std::numbers::pi * t));
}

inline Eigen::VectorXd Helix(double t) {
  const double radius = 1 + 0.3 * std::cos(10 * std::numbers::pi * t);
  return Eigen::Vector3d(radius * std::cos(6 * std::numbers::pi * t),
                         radius * std::sin(6 * std::numbers::pi * t),
                         2 * t);
}

// Patches over the unit square.
inline Eigen::Vector3d Cylinder(double u, double v) {
  const double a = (-45 + 90 * u) * std::numbers::pi / 180;
  return {std::sin(a), v, std::cos(a)};
}

inline Eigen::Vector3d Sphere(double u, double v) {
  const double a = (-35 + 70 * u) * std::numbers::pi / 180,
               b = (-35 + 70 * v) * std::numbers::pi / 180;
  return {std::sin(a) * std::cos(b), std::sin(b), std::cos(a) * std::cos(b)};
}

inline Eigen::Vector3d Torus(double u, double v) {
  const double a = (-30 + 60 * u) * std::numbers::pi / 180,
               b = (-40 + 80 * v) * std::numbers::pi / 180;
  const double radius = 2 + 0.7 * std::cos(b);
  return {radius * std::sin(a), 0.7 * std::sin(b), radius * std::cos(a)};
}

inline NurbsSurface RandomRational(int seed) {
  std::mt19937_64 engine(seed);
  const auto even = [&] { return 2 * Uniform(engine) - 1; };
  const SplineBasis basis = SplineBasis::Uniform(3, 6, 0, 1);
  Eigen::Matrix3Xd net(3, 36);
  Eigen::VectorXd weights(36);
  for (int k = 0; k < 36; ++k) {
    net(0, k) = basis.Greville(k / 6) + 0.03 * even();
    net(1, k) = basis.Greville(k % 6) + 0.03 * even();
    net(2, k) = 0.2 * even();
    weights[k] = std::exp(0.5 * even());
  }
  return NurbsSurface(basis, basis, net, weights);
}

// Functions of one variable.
inline double Step(double x) { return 90 / (1 + std::exp(-100 * (x - 0.4))); }
inline double Cusp(double x) {
  return 100 * std::exp(-std::abs(10 * x - 5)) + std::pow(10 * x - 5, 5) / 500;
}
inline double Peak(double x) { return 0.01 / (0.01 + (x - 0.3) * (x - 0.3)); }
inline double Bump(double x) { return std::sin(2 * x) + 2 * std::exp(-16 * x * x) + 2; }

// De Boor & Rice's measurements of titanium, at 595, 605 … 1075. [de Boor & Rice 1968]
inline double Titanium(double x) {
  constexpr double kProperty[] = {
      0.644, 0.622, 0.638, 0.649, 0.652, 0.639, 0.646, 0.657, 0.652, 0.655, 0.644, 0.663, 0.663,
      0.668, 0.676, 0.676, 0.686, 0.679, 0.678, 0.683, 0.694, 0.699, 0.710, 0.730, 0.763, 0.812,
      0.907, 1.044, 1.336, 1.881, 2.169, 2.075, 1.598, 1.211, 0.916, 0.746, 0.672, 0.627, 0.615,
      0.607, 0.606, 0.609, 0.603, 0.601, 0.603, 0.601, 0.611, 0.601, 0.608};
  return kProperty[std::lround((x - 595) / 10)];
}

}  // namespace batten::internal
