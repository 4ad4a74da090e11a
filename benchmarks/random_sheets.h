// SPDX-License-Identifier: MIT
// Smooth sheets that nobody chose: bicubic nets bent up to a full turn, with an outline, a density,
// noise, outliers and clutter drawn at random.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <numbers>
#include <vector>

#include "batten/geometry/nurbs_surface.h"
#include "known_sheets.h"

namespace batten::internal {

struct RandomSheet {
  KnownSheet sheet;
  Eigen::Index count = 0;                         // points on it
  std::function<bool(double, double)> within;     // its outline, in the unit square
  std::function<double(double, double)> density;  // of points over area, at most 1
  double outliers = 0;                            // over the points on it
  int clutter = 0;                                // objects beside it
  double sigma = 0;
};

// A net of 4–8 control points a side over a cylinder's or a saddle's part, each moved along the
// normal, and less along the sheet.
template <typename Variation>
KnownSheet RandomNet(Variation& vary) {
  const int nu = 4 + static_cast<int>(5 * vary.Uniform()),
            nv = 4 + static_cast<int>(5 * vary.Uniform());
  const double length = 1, width = std::exp(std::log(0.4) + std::log(4.0) * vary.Uniform());
  const double bend = vary.Uniform() < 0.3 ? 0 : Radians(345) * vary.Uniform(),
               skew = 0.5 * (vary.Uniform() - 0.5);
  // Saddles and barrels keep a radius, and what is moved stays off the axis.
  const double cross =
      std::min(Radians(50), 2.4 / (bend * width + 1e-9)) * (2 * vary.Uniform() - 1);
  const double cell = std::min(length / (nu - 1), width / (nv - 1)),
               rough = std::min(0.2 * cell, 0.12 / (bend + 1e-9)) * vary.Uniform();
  const auto base = [&](double s, double t) {  // arc lengths from the middle
    const double along = s + skew * t, angle = bend * along;
    const double lift = cross * t * t / (2 * width);
    const double radius = bend > 1e-9 ? 1 / bend - lift : 0;
    return bend > 1e-9
               ? Eigen::Vector3d(radius * std::sin(angle), t, 1 / bend - radius * std::cos(angle))
               : Eigen::Vector3d(along, t, lift);
  };
  const SplineBasis u = SplineBasis::Uniform(3, nu, 0, 1), v = SplineBasis::Uniform(3, nv, 0, 1);
  const auto greville = [](const SplineBasis& basis, int k) {
    return (basis.knots()[k + 1] + basis.knots()[k + 2] + basis.knots()[k + 3]) / 3;
  };
  Eigen::Matrix3Xd net(3, nu * nv);
  for (int i = 0; i < nu; ++i) {
    for (int j = 0; j < nv; ++j) {
      const double s = length * (greville(u, i) - 0.5), t = width * (greville(v, j) - 0.5);
      constexpr double kStep = 1e-5;
      const Eigen::Vector3d normal = (base(s + kStep, t) - base(s - kStep, t))
                                         .cross(base(s, t + kStep) - base(s, t - kStep))
                                         .normalized();
      net.col(i * nv + j) = base(s + 0.3 * rough * vary.Normal(), t + 0.3 * rough * vary.Normal()) +
                            rough * vary.Normal() * normal;
    }
  }
  const auto surface = std::make_shared<const NurbsSurface>(u, v, net);
  return {"random sheet",
          [surface](double a, double b) {
            return Eigen::Vector3d(surface->At(std::clamp(a, 0.0, 1.0), std::clamp(b, 0.0, 1.0)));
          },
          {length, width},
          {}};
}

// The whole square, a trapezium, an ellipse, a wavy disc, or the square without a disc.
template <typename Variation>
std::function<bool(double, double)> RandomOutline(Variation& vary) {
  const double kind = vary.Uniform(), a = vary.Uniform(), b = vary.Uniform(), c = vary.Uniform();
  if (kind < 0.4) return [](double, double) { return true; };
  if (kind < 0.55)
    return [=](double u, double v) {
      return v > 0.3 * a * u && v < 1 - 0.4 * b * u && u > 0.2 * c * v;
    };
  if (kind < 0.7)
    return [=](double u, double v) {
      return std::hypot((u - 0.5) / (0.35 + 0.15 * a), (v - 0.5) / (0.35 + 0.15 * b)) < 1;
    };
  if (kind < 0.85) {
    const int waves = 2 + static_cast<int>(4 * c);
    return [=](double u, double v) {
      const double x = u - 0.5, y = v - 0.5;
      return std::hypot(x, y) < 0.4 + 0.09 * a * std::cos(waves * std::atan2(y, x) + 6.3 * b);
    };
  }
  return [=](double u, double v) {
    return std::hypot(u - 0.25 - 0.5 * a, v - 0.25 - 0.5 * b) > 0.05 + 0.12 * c;
  };
}

template <typename Variation>
RandomSheet DrawRandomSheet(Variation& vary) {
  RandomSheet drawn;
  drawn.sheet = RandomNet(vary);
  drawn.within = RandomOutline(vary);
  const double thin = vary.Uniform() < 0.5 ? 0 : std::log(10.0) * vary.Uniform(),
               way = 2 * std::numbers::pi * vary.Uniform();
  const double wx = std::cos(way), wy = std::sin(way);
  drawn.density = [=](double u, double v) {  // at most 1 where wx·u + wy·v is least
    const double at = wx * u + wy * v - std::min(wx, 0.0) - std::min(wy, 0.0);
    return std::exp(-thin * at / (std::abs(wx) + std::abs(wy)));
  };
  drawn.count = static_cast<Eigen::Index>(5000 * std::pow(8, vary.Uniform()));
  drawn.sigma = 2e-4 * std::pow(15, vary.Uniform());
  drawn.outliers = vary.Uniform() < 0.5 ? 0 : 0.2 * vary.Uniform();
  drawn.clutter = vary.Uniform() < 0.5 ? 0 : static_cast<int>(4 * vary.Uniform());
  return drawn;
}

}  // namespace batten::internal
