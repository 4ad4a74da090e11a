// SPDX-License-Identifier: MIT
// The signed distance of a point from a primitive surface and its gradient by the surface's
// freedoms. Used by the surface fits only.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "fitting/primitives/surface_contact.h"

namespace batten::internal {

// Of the radius: nearer to the centre, gradients are as if it were so far.
inline constexpr double kAtCenter = 1e-8;

// The distance from a circle of curvature κ through 0 whose centre is at −1/κ on the first axis:
// (s − 1)/κ with s = |(1 + κ x, κ y)|, which is q/(1 + s), q = 2 x + κ (x² + y²): no difference of
// large numbers where κ is small.
struct CircleDistance {
  double value, by_x, by_y, by_curvature;

  CircleDistance(double x, double y, double kappa) {
    const double square = x * x + y * y, q = 2 * x + kappa * square;
    const double a = 1 + kappa * x, b = kappa * y;
    const double s = std::sqrt(a * a + b * b), safe = std::max(s, kAtCenter), over = 1 / (1 + s);
    value = q * over;
    by_x = a / safe;
    by_y = b / safe;
    by_curvature = square * over - q * (q + kappa * square) / (2 * safe) * over * over;
  }
};

// Distances from one shape. Its freedoms, in this order: a shift along the normal; turns about
// Across() and `along` at the point; the curvature (sphere) or axis curvature (cylinder and
// beyond); a turn about the normal; the slope; the profile's curvature. Each kind has the first
// FreedomsOf(kind): the others move it along itself.
template <SurfaceKind kKind>
class SurfaceDistance {
 public:
  static constexpr int kFreedoms = FreedomsOf(kKind);
  using Row = Eigen::Matrix<double, kFreedoms, 1>;

  explicit SurfaceDistance(const SurfaceContact& shape)
      : shape_(shape),
        across_(shape.Across()),
        sine_(std::sin(shape.slope)),
        cosine_(std::cos(shape.slope)) {}

  double operator()(const Eigen::Vector3d& p, Row& row) const {
    const Eigen::Vector3d from = p - shape_.point;
    const double n = from.dot(shape_.normal), c = from.dot(across_), t = from.dot(shape_.along);
    if constexpr (kKind == SurfaceKind::kPlane) {
      row << -1, -t, c;
      return n;
    } else if constexpr (kKind == SurfaceKind::kSphere) {
      return OfSphere(n, c, t, row);
    } else {
      const double x = cosine_ * n - sine_ * t, height = sine_ * n + cosine_ * t;
      const CircleDistance round(x, c, shape_.axis_curvature);
      const Meridian here{round.value, height, x, round.by_x, round.by_y, round.by_curvature};
      return OfProfile(here, n, c, t, row);
    }
  }

 private:
  // A point's place in its meridian half-plane with derivatives: the distance from the axis less
  // that of the shape's point, and the height above it along the axis.
  struct Meridian {
    double over, height, x;
    double over_by_x, over_by_across, over_by_axis_curvature;
  };

  double OfSphere(double n, double c, double t, Row& row) const {
    const double kappa = shape_.curvature, square = n * n + c * c + t * t;
    const double q = 2 * n + kappa * square, a = 1 + kappa * n;
    const double s = std::sqrt(a * a + kappa * kappa * (c * c + t * t));
    const double safe = std::max(s, kAtCenter), over = 1 / (1 + s);
    row[0] = -a / safe;
    row[1] = -t / safe;
    row[2] = c / safe;
    row[3] = square * over - q * (q + kappa * square) / (2 * safe) * over * over;
    return q * over;
  }

  double OfProfile(const Meridian& m, double n, double c, double t, Row& row) const {
    double along_normal = m.over, along_profile = m.height;
    if constexpr (kKind != SurfaceKind::kCylinder) {
      along_normal = cosine_ * m.over + sine_ * m.height;
      along_profile = cosine_ * m.height - sine_ * m.over;
    }
    double value = along_normal, by_normal = 1, by_profile = 0, by_curvature = 0;
    if constexpr (kKind == SurfaceKind::kTorus) {
      const CircleDistance profile(along_normal, along_profile, shape_.curvature);
      value = profile.value;
      by_normal = profile.by_x;
      by_profile = profile.by_y;
      by_curvature = profile.by_curvature;
    }
    const double by_over = cosine_ * by_normal - sine_ * by_profile;
    const double by_height = sine_ * by_normal + cosine_ * by_profile;
    // The gradient across the axis, round it and along it, then along normal and profile.
    const double g_x = by_over * m.over_by_x, g_c = by_over * m.over_by_across;
    const double g_n = cosine_ * g_x + sine_ * by_height;
    const double g_t = cosine_ * by_height - sine_ * g_x;
    row[0] = -g_n;
    row[1] = n * g_t - t * g_n;
    row[2] = c * g_n - n * g_c;
    row[3] = by_over * m.over_by_axis_curvature;
    row[4] = t * g_c - c * g_t;
    if constexpr (kFreedoms > 5) {
      row[5] =
          by_normal * along_profile - by_profile * along_normal - m.height * g_x + m.x * by_height;
    }
    if constexpr (kFreedoms > 6) row[6] = by_curvature;
    return value;
  }

  const SurfaceContact shape_;
  const Eigen::Vector3d across_;
  const double sine_, cosine_;
};

// Calls body with the kind as a constant: WithKind(kind, []<SurfaceKind kKind>() { … }).
template <typename Body>
decltype(auto) WithKind(SurfaceKind kind, const Body& body) {
  switch (kind) {
    case SurfaceKind::kPlane:
      return body.template operator()<SurfaceKind::kPlane>();
    case SurfaceKind::kSphere:
      return body.template operator()<SurfaceKind::kSphere>();
    case SurfaceKind::kCylinder:
      return body.template operator()<SurfaceKind::kCylinder>();
    case SurfaceKind::kCone:
      return body.template operator()<SurfaceKind::kCone>();
    case SurfaceKind::kTorus:
      break;
  }
  return body.template operator()<SurfaceKind::kTorus>();
}

}  // namespace batten::internal
