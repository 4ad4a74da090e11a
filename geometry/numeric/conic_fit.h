// SPDX-License-Identifier: MIT
// Conics through points of the plane, by least squares, and how far points lie from them.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>

namespace batten::internal {

// F(x) = A X² + B XY + C Y² + D X + E Y + G with (X, Y) = (x·axis_0, x·axis_1) / stretch, x taken
// from `origin`. Stretched along their principal axes the points fill a square, so that even flat
// arcs determine the coefficients to rounding; F carries no centre or vertex, which may lie far
// away. The quadratic part is homogeneous of degree 2, so scaling F changes nothing.
struct PlaneConic {
  Eigen::Vector2d origin = Eigen::Vector2d::Zero();
  Eigen::Matrix2d axes = Eigen::Matrix2d::Identity();  // columns, orthonormal
  Eigen::Vector2d stretch = Eigen::Vector2d::Ones();
  Eigen::Matrix<double, 6, 1> coefficients = Eigen::Matrix<double, 6, 1>::Zero();  // A … G

  // An upper bound of the distance to the conic, exact to second order near it: where F vanishes on
  // the line through `point` along the gradient. Infinite where it does not.
  double DistanceBound(const Eigen::Vector2d& point) const;

  // F = x'·matrix·x + linear·x + constant in the unstretched frame of `axes` about `origin`.
  Eigen::Matrix2d Quadratic() const;
  Eigen::Vector2d Linear() const;
  double Constant() const { return coefficients[5]; }

  // From the frame of `axes` to the plane the points were given in.
  Eigen::Vector2d Back(const Eigen::Vector2d& local) const { return origin + axes * local; }
};

// The best circle, parabola or conic of any kind, minimal in Σ (F/|∇F|)² up to the reweighting of
// the last of few steps. Points lie exactly on the result where they lie on such a curve; none is
// promised otherwise. Needs points that are not all on one line. O(points).
PlaneConic FitCircle(const Eigen::Matrix2Xd& points);
PlaneConic FitParabola(const Eigen::Matrix2Xd& points);
PlaneConic FitConic(const Eigen::Matrix2Xd& points);

// The unit vector v with the least |design · v|.
Eigen::VectorXd NullVector(const Eigen::MatrixXd& design);

struct PlaneCircle {
  Eigen::Vector2d center;
  double radius;
};

// Centre and radius of what FitCircle returned; none where it is a line or imaginary.
std::optional<PlaneCircle> CircleOf(const PlaneConic& conic);

}  // namespace batten::internal
