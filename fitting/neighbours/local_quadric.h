// SPDX-License-Identifier: MIT
// A plane or a quadric height field through a handful of neighbours.
#pragma once

#include <Eigen/Core>

namespace batten::internal {

// A plane by a point of it and its unit normal.
struct LocalPlane {
  Eigen::Vector3d centre, normal;
};

// The plane of least weighted squared distances to points (3 × m, m ≥ 1; weights ≥ 0, not all 0).
LocalPlane WeightedPlane(const Eigen::Matrix3Xd& points, const Eigen::VectorXd& weights);

// The plane most of the points agree on, by Cauchy weights at the median deviation, and the robust
// standard deviation of the points from it (1.4826 × the median).
struct AgreedPlane {
  LocalPlane plane;
  double scale = 0;
};
AgreedPlane PlaneMostAgreeOn(const Eigen::Matrix3Xd& points);

// The quadric z(x, y) with its six coefficients in the frame of a plane, lengths relative to the
// radius of its points.
class LocalQuadric {
 public:
  // Least squares over the points (3 × m, m ≥ 6) in the frame of the plane that fits them.
  explicit LocalQuadric(const Eigen::Matrix3Xd& points);
  // The same in the frame of a plane that is known, however large the heights over it.
  static LocalQuadric Over(const LocalPlane& plane, const Eigen::Matrix3Xd& points);
  // The quadric most of the points agree on, by Cauchy weights as above.
  static LocalQuadric MostAgreeOn(const Eigen::Matrix3Xd& points);

  // What a point's height exceeds the quadric by.
  double Offset(const Eigen::Vector3d& point) const;
  // Variance of the quadric's own height at a point's place, relative to that of one datum: below
  // 1 among the points, growing quickly beyond them.
  double Leverage(const Eigen::Vector3d& point) const;
  // The frame's plane, and the distance from its centre to the farthest point (to the farthest
  // place, if the plane was given), the unit of the residuals.
  const LocalPlane& plane() const { return plane_; }
  double radius() const { return radius_; }
  // Offsets of the points it was made of over the radius. In the data's units: their root of the
  // sum of squares over the freedom left, and 1.4826 × their median.
  const Eigen::VectorXd& residuals() const { return residuals_; }
  double deviation() const;
  double robust_scale() const;
  // The same from the 80 % quantile: large where a third of the points disagrees.
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
