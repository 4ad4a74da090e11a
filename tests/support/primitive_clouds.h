// SPDX-License-Identifier: MIT
// Points on lines and circles in any place, and how far shapes are from points.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <random>
#include <variant>

#include "batten/fitting/fit_primitive.h"
#include "dense_samples.h"
#include "measured_shapes.h"
#include "random_splines.h"

namespace batten::internal {

inline constexpr double kDegree = std::numbers::pi / 180;

inline PrimitiveFitOptions Options(PrimitiveKind kind, std::optional<Loss> loss = std::nullopt) {
  PrimitiveFitOptions options;
  options.kind = kind;
  options.loss = loss;
  options.threads = 2;
  return options;
}

struct Place {
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();
  double scale = 1;
  Eigen::Matrix3Xd operator()(const Eigen::Matrix3Xd& points) const {
    return (scale * turn * points).colwise() + shift;
  }
};

inline Place RandomPlace(RandomSplines& random, bool plane, double distance = 10) {
  Place place;
  place.turn = random.Orthogonal();
  if (place.turn.determinant() < 0) place.turn.col(0) *= -1;
  if (plane) {
    place.turn = Eigen::AngleAxisd(random.Real(0, 7), Eigen::Vector3d::UnitZ()).matrix();
  }
  place.shift = random.Vector(distance);
  if (plane) place.shift.z() = 0;
  return place;
}

class Noise {
 public:
  explicit Noise(unsigned seed) : engine_(seed) {}
  double operator()() { return normal_(engine_); }
  // Normal in every coordinate that there is.
  void AddTo(Eigen::Matrix3Xd& points, double sigma, bool plane) {
    for (auto p : points.colwise()) {
      for (int i = 0; i < (plane ? 2 : 3); ++i) p[i] += sigma * (*this)();
    }
  }

 private:
  std::mt19937_64 engine_;
  std::normal_distribution<double> normal_;
};

// On the unit circle of the xy plane, evenly over the sweep.
inline Eigen::Matrix3Xd ArcPoints(int count, double sweep, double start = 0) {
  Eigen::Matrix3Xd points(3, count);
  for (int k = 0; k < count; ++k) {
    const double a = start + sweep * k / (count - 1);
    points.col(k) << std::cos(a), std::sin(a), 0;
  }
  return points;
}

inline Eigen::Matrix3Xd LinePoints(int count, double length) {
  Eigen::Matrix3Xd points = Eigen::Matrix3Xd::Zero(3, count);
  for (int k = 0; k < count; ++k) points(0, k) = length * (k / (count - 1.0) - 0.5);
  return points;
}

inline PointCloud Cloud(const Eigen::Matrix3Xd& points, bool plane) {
  return PointCloud::FromWorld(points, plane ? 2 : 3);
}

// Distances by the plain formulas.
inline double DistanceTo(const CircleShape& circle, const Eigen::Vector3d& p) {
  const Eigen::Vector3d from = p - circle.center;
  const double height = from.dot(circle.normal);
  return std::hypot(height, (from - height * circle.normal).norm() - circle.radius);
}

inline double DistanceTo(const LineShape& line, const Eigen::Vector3d& p) {
  return (p - line.point).cross(line.direction).norm();
}

// The largest distance of the curve from the shape, over dense samples.
template <int Dim, typename Shape>
double OffShape(const NurbsCurve<Dim>& curve, const Shape& shape) {
  double most = 0;
  for (const double u : DenseParameters(curve.basis(), 100)) {
    Eigen::Vector3d p = Eigen::Vector3d::Zero();
    p.template head<Dim>() = curve.At(u);
    most = std::max(most, DistanceTo(shape, p));
  }
  return most;
}

template <typename Shape>
double OffShape(const NurbsSurface& surface, const Shape& shape) {
  double most = 0;
  for (int i = 0; i <= 40; ++i) {
    for (int j = 0; j <= 40; ++j) {
      most = std::max(most, DistanceTo(SurfaceShape(shape), surface.At(i / 40.0, j / 40.0)));
    }
  }
  return most;
}

inline double OffShape(const PrimitiveFit& fit) {
  return std::visit(
      [](const auto& geometry, const auto& shape) {
        using Form = std::decay_t<decltype(shape)>;
        constexpr bool kCurve =
            std::is_same_v<Form, LineShape> || std::is_same_v<Form, CircleShape>;
        if constexpr (kCurve != std::is_same_v<std::decay_t<decltype(geometry)>, NurbsSurface>) {
          return OffShape(geometry, shape);
        } else {
          return std::numeric_limits<double>::infinity();
        }
      },
      fit.geometry,
      fit.shape);
}

}  // namespace batten::internal
