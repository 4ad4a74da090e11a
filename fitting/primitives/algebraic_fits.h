// SPDX-License-Identifier: MIT
// Algebraic fits of spheres, and of cylinders, cones and tori about given axes, from the moments of
// points: start values of the orthogonal-distance fit.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "fitting/primitives/fitted_surface.h"
#include "geometry/numeric/dense_solvers.h"

namespace batten::internal {

// A line that a shape may turn about.
struct Axis {
  Eigen::Vector3d point, direction;
};

// Distances of points from an axis, and heights along it.
Eigen::Matrix2Xd MeridianOf(const Eigen::Matrix3Xd& points, const Axis& axis);

// The circle or sphere A(|x|² − mean) + b·x = 0 about the centroid of points with the least
// Σ w F² over Σ w |∇F|². [Taubin 1991]
template <int Dim>
struct AlgebraicRound {
  using Columns = Eigen::Matrix<double, Dim, Eigen::Dynamic>;

  Eigen::Matrix<double, Dim, 1> outward;  // at its point nearest to the centroid
  double distance = 0;                    // of that point from the centroid, along −outward
  double curvature = 0;

  explicit AlgebraicRound(const Columns& x) : AlgebraicRound(x, Eigen::VectorXd::Ones(x.cols())) {}
  AlgebraicRound(const Columns& x, const Eigen::VectorXd& weights) {
    using Row = Eigen::Matrix<double, Dim + 1, 1>;
    using Moments = Eigen::Matrix<double, Dim + 1, Dim + 1>;
    const double mean = std::max(x.colwise().squaredNorm().dot(weights) / weights.sum(), 1e-300);
    const double root = std::sqrt(mean);
    Moments moments = Moments::Zero();
    for (Eigen::Index k = 0; k < x.cols(); ++k) {
      Row row;
      row << (x.col(k).squaredNorm() - mean) / (2 * root), x.col(k);
      moments += weights[k] * row * row.transpose();
    }
    Row v = EigenOf(moments).vectors.col(0);
    if (v[0] < 0) v = -v;
    const double a = v[0] / (2 * root), d = -a * mean;
    const Eigen::Matrix<double, Dim, 1> b = v.template tail<Dim>();
    const double slope = b.norm(), root_of_form = std::hypot(slope, 2 * a * root);
    outward = slope > 0 ? (b / slope).eval() : Eigen::Matrix<double, Dim, 1>::UnitX().eval();
    distance = 2 * d / (root_of_form + slope);
    curvature = 2 * a / root_of_form;
  }
};

// The sphere of least algebraic distance. It has curvature zero where the points lie in a plane or
// on a line. [Taubin 1991]
FittedSurface AlgebraicSphereFit(const Eigen::Matrix3Xd& points);
FittedSurface AlgebraicCylinderFit(const Eigen::Matrix3Xd& points, const Eigen::Vector3d& axis);

// Cone and torus of revolution about `axis`: the profile is the line, or the algebraic circle,
// fitted to the points in their meridian half-planes.
FittedSurface AlgebraicConeFit(const Eigen::Matrix3Xd& points, const Axis& axis);
FittedSurface AlgebraicTorusFit(const Eigen::Matrix3Xd& points, const Axis& axis);

}  // namespace batten::internal
