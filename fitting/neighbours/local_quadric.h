// SPDX-License-Identifier: MIT
// Local fits to a few neighbours: a plane, or a quadric height field over it.
#pragma once

#include <Eigen/Core>

namespace batten::internal {

// A plane by a point of it and its unit normal.
struct LocalPlane {
  Eigen::Vector3d centre, normal;
};

// Fits a plane by weighted least squares to points (3 × m, m ≥ 1; weights ≥ 0, not all 0).
LocalPlane WeightedPlane(const Eigen::Matrix3Xd& points, const Eigen::VectorXd& weights);

// Robust plane fit by Cauchy weights scaled by the median deviation, with the robust standard
// deviation of the points from it (1.4826 × the median).
struct AgreedPlane {
  LocalPlane plane;
  double scale = 0;
};
AgreedPlane PlaneMostAgreeOn(const Eigen::Matrix3Xd& points);

// The quadric z(x, y) with its six coefficients in the frame of a plane, lengths relative to the
// radius of its points.
class LocalQuadric {
 public:
  // Fits the points (3 × m, m ≥ 6) by least squares in the frame of their least-squares plane.
  explicit LocalQuadric(const Eigen::Matrix3Xd& points);
  // Fits in the frame of a given plane, however large the heights over it.
  static LocalQuadric Over(const LocalPlane& plane, const Eigen::Matrix3Xd& points);
  // Fits robustly, by Cauchy weights as above.
  static LocalQuadric MostAgreeOn(const Eigen::Matrix3Xd& points);

  // Signed height of a point over the quadric.
  double Offset(const Eigen::Vector3d& point) const;
  // Variance of the quadric's height at a point's place, relative to that of one datum: below 1
  // among the points, growing quickly beyond them.
  double Leverage(const Eigen::Vector3d& point) const;
  // The frame's plane, and the distance from its centre to the farthest point (to the farthest
  // place, if the plane was given), the unit of the residuals.
  const LocalPlane& plane() const { return plane_; }
  double radius() const { return radius_; }
  // Residuals of the points fitted, relative to the radius. In the data's units: the root of the
  // sum of their squares over the degrees of freedom, and 1.4826 × their median.
  const Eigen::VectorXd& residuals() const { return residuals_; }
  double deviation() const;
  double robust_scale() const;
  // Robust standard deviation from the 80 % quantile: large where a third of the points disagrees.
  double scale_of_most() const;

 private:
  using Vector6d = Eigen::Matrix<double, 6, 1>;
  LocalQuadric(const Eigen::Matrix3Xd& points, const LocalPlane& plane);
  LocalQuadric(const Eigen::Matrix3Xd& points, const LocalPlane& plane, double radius);
  Vector6d Monomials(const Eigen::Vector3d& point) const;
  void Solve(const Eigen::VectorXd& weights);

  LocalPlane plane_;
  Eigen::Vector3d axis_u_, axis_v_;
  double radius_ = 0;
  Eigen::Matrix<double, Eigen::Dynamic, 6> design_;
  Eigen::VectorXd heights_, residuals_;
  Vector6d coefficients_;
  Eigen::Matrix<double, 6, 6> covariance_;
};

}  // namespace batten::internal
