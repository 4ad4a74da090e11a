// SPDX-License-Identifier: MIT
// Circles and surfaces of revolution as exact rational quadratics. [Piegl & Tiller 1997, §7.5,
// §8.5]
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <initializer_list>
#include <numbers>
#include <utility>
#include <vector>

#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"

namespace batten::internal {

// The quadratic basis of `quarters` quarter circles, on [0, 1].
inline SplineBasis ArcBasis(int quarters) {
  std::vector<double> knots(3, 0.0);
  for (int k = 1; k < quarters; ++k) knots.insert(knots.end(), 2, double(k) / quarters);
  knots.insert(knots.end(), 3, 1.0);
  return SplineBasis(2, std::move(knots));
}

// 2·quarters + 1 control points and weights of an arc of radius one about the origin.
inline Eigen::Matrix3Xd ArcPointsAndWeights(int quarters, double start = 0) {
  Eigen::Matrix3Xd result(3, 2 * quarters + 1);
  const double half = std::numbers::sqrt2 / 2;
  for (int k = 0; k <= 2 * quarters; ++k) {
    const double angle = start + k * std::numbers::pi / 4, radius = k % 2 == 0 ? 1 : 1 / half;
    result.col(k) << radius * std::cos(angle), radius * std::sin(angle), k % 2 == 0 ? 1 : half;
  }
  return result;
}

// The full circle of 9 control points about the origin.
inline NurbsCurve<2> Circle(double radius) {
  const Eigen::Matrix3Xd arc = ArcPointsAndWeights(4);
  return NurbsCurve<2>(ArcBasis(4), radius * arc.topRows<2>(), arc.row(2).transpose());
}

// The profile (column: distance from the z axis, height), turned about the z axis; u turns, v runs
// along the profile. The normal S_u × S_v looks outward where the profile rises.
inline NurbsSurface Revolved(SplineBasis profile_basis,
                             const Eigen::Matrix2Xd& profile,
                             const Eigen::VectorXd& profile_weights) {
  const Eigen::Matrix3Xd arc = ArcPointsAndWeights(4);
  Eigen::Matrix3Xd points(3, arc.cols() * profile.cols());
  Eigen::VectorXd weights(points.cols());
  for (Eigen::Index i = 0; i < arc.cols(); ++i) {
    for (Eigen::Index j = 0; j < profile.cols(); ++j) {
      const Eigen::Index column = i * profile.cols() + j;
      points.col(column) << profile(0, j) * arc(0, i), profile(0, j) * arc(1, i), profile(1, j);
      weights[column] = arc(2, i) * profile_weights[j];
    }
  }
  return NurbsSurface(ArcBasis(4), std::move(profile_basis), std::move(points), std::move(weights));
}

// The sphere about the origin; both poles are collapsed edges.
inline NurbsSurface Sphere(double radius) {
  Eigen::Matrix3Xd arc = ArcPointsAndWeights(2, -std::numbers::pi / 2);
  arc(0, 0) = arc(0, 4) = 0;  // the poles lie on the axis exactly
  return Revolved(ArcBasis(2), radius * arc.topRows<2>(), arc.row(2).transpose());
}

// The cylinder about the z axis, z in [0, height].
inline NurbsSurface Cylinder(double radius, double height) {
  return Revolved(SplineBasis(1, {0, 0, 1, 1}),
                  Eigen::Matrix2d{{radius, radius}, {0, height}},
                  Eigen::VectorXd::Ones(2));
}

// The cone with its tip, a collapsed edge, at the origin.
inline NurbsSurface Cone(double radius, double height) {
  return Revolved(SplineBasis(1, {0, 0, 1, 1}),
                  Eigen::Matrix2d{{0, radius}, {0, height}},
                  Eigen::VectorXd::Ones(2));
}

// The torus about the z axis; the tube is a circle of radius `minor` at distance `major`.
inline NurbsSurface Torus(double major, double minor) {
  const Eigen::Matrix3Xd arc = ArcPointsAndWeights(4);
  Eigen::Matrix2Xd profile = minor * arc.topRows<2>();
  profile.row(0).array() += major;
  return Revolved(ArcBasis(4), profile, arc.row(2).transpose());
}

}  // namespace batten::internal
