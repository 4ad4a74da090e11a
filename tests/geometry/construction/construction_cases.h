// SPDX-License-Identifier: MIT
// Curves and measures that the tests of constructions share.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <initializer_list>
#include <numbers>
#include <vector>

#include "batten/geometry/foot_point.h"
#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"
#include "batten/geometry/transform.h"
#include "random_splines.h"

namespace batten::internal {

inline constexpr double kPi = std::numbers::pi;

// The largest distance of the surface along (u(t), v(t)) from the curve at t, over its domain.
inline double DistanceAlong(const NurbsSurface& surface,
                            const std::function<Eigen::Vector2d(double)>& place,
                            const std::function<Eigen::Vector3d(double)>& curve) {
  double worst = 0;
  for (int k = 0; k <= 200; ++k) {
    const double t = k / 200.0;
    const Eigen::Vector2d uv = place(t);
    worst = std::max(worst, (surface.At(uv.x(), uv.y()) - curve(t)).norm());
  }
  return worst;
}

// A curve at a share of its domain.
inline Eigen::Vector3d AtShare(const NurbsCurve<3>& curve, double share) {
  const SplineBasis& basis = curve.basis();
  return curve.At(basis.lower() + share * (basis.upper() - basis.lower()));
}

// The largest distance of points of `points_of` from the curve.
inline double FarthestFrom(const NurbsCurve<3>& curve, const NurbsCurve<3>& points_of) {
  const CurveFootPoints<3> feet(curve);
  double worst = 0;
  for (int k = 0; k <= 60; ++k) {
    worst = std::max(worst, feet.Nearest(AtShare(points_of, k / 60.0)).distance);
  }
  return worst;
}

// A polynomial or rational curve near the segment from `from` to `to`.
inline NurbsCurve<3> NearSegment(RandomSplines& random,
                                 const Eigen::Vector3d& from,
                                 const Eigen::Vector3d& to,
                                 double off,
                                 int degree,
                                 bool rational) {
  const SplineBasis basis = random.Basis(degree, {.most_spans = 4});
  Eigen::Matrix3Xd points(3, basis.size());
  for (int i = 0; i < basis.size(); ++i) {
    const double share = (basis.Greville(i) - basis.lower()) / (basis.upper() - basis.lower());
    points.col(i) = from + share * (to - from);
    if (i > 0 && i + 1 < basis.size()) points.col(i) += random.Vector(off);
  }
  return NurbsCurve<3>(
      basis, points, rational ? random.Weights(basis.size(), 0.5, 2) : Eigen::VectorXd());
}

inline NurbsCurve<3> Cubic(std::initializer_list<Eigen::Vector3d> points) {
  Eigen::Matrix3Xd net(3, points.size());
  Eigen::Index column = 0;
  for (const Eigen::Vector3d& point : points) net.col(column++) = point;
  return NurbsCurve<3>(SplineBasis::Uniform(3, static_cast<int>(net.cols()), 0, 1), net);
}

// Of independent directions, not a similarity.
inline Eigen::Matrix4d SkewMap() {
  Eigen::Matrix4d map = Eigen::Matrix4d::Identity();
  map.topRows<3>() << 2, 0.3, -0.1, 5, 0.1, 0.7, 0.2, -3, -0.4, 0.2, 1.1, 8;
  return map;
}

inline double LargestDifference(const NurbsSurface& a, const NurbsSurface& b) {
  double worst = 0;
  for (int i = 0; i <= 23; ++i) {
    for (int j = 0; j <= 23; ++j) {
      worst = std::max(worst, (a.At(i / 23.0, j / 23.0) - b.At(i / 23.0, j / 23.0)).norm());
    }
  }
  return worst;
}

}  // namespace batten::internal
