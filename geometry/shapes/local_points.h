// SPDX-License-Identifier: MIT
// A shape moved near the origin and scaled to about one, so that neither its place nor its size
// costs digits.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>

namespace batten::internal {

// local = (points − first point) · 2^k, k such that the largest local coordinate is in [1/2, 1):
// the scaling is exact, the difference nearly.
class LocalFrame {
 public:
  template <typename Points>
  explicit LocalFrame(const Points& points) {
    const double largest = points.cwiseAbs().maxCoeff();
    std::frexp(largest, &large_);
    const Eigen::MatrixXd reduced =
        points.unaryExpr([&](double x) { return std::ldexp(x, -large_); });
    origin_.setZero();
    origin_.head(points.rows()) = reduced.col(0);
    const double extent = (reduced.colwise() - reduced.col(0)).cwiseAbs().maxCoeff();
    std::frexp(extent, &small_);
    coordinate_ = std::ldexp(largest, -large_ - small_);
    collapsed_ = !(extent > 0);
  }

  // Every point is the same.
  bool collapsed() const { return collapsed_; }

  template <typename Points>
  Points ToLocal(const Points& points) const {
    Points local = points.unaryExpr([&](double x) { return std::ldexp(x, -large_); });
    local.colwise() -= origin_.head<Points::RowsAtCompileTime>().eval();
    return local.unaryExpr([&](double x) { return std::ldexp(x, -small_); });
  }

  Eigen::Vector3d Point(const Eigen::Vector3d& local) const {
    return (local.unaryExpr([&](double x) { return std::ldexp(x, small_); }) + origin_)
        .unaryExpr([&](double x) { return std::ldexp(x, large_); });
  }
  double Length(double local) const { return std::ldexp(local, small_ + large_); }

  // `relative` of a local length, but not less than eight units in the last place of the largest
  // coordinate.
  double Tolerance(double relative, double length) const {
    constexpr double kPlaces = 8;
    return std::max(relative * length,
                    kPlaces * std::numeric_limits<double>::epsilon() * coordinate_);
  }

 private:
  int large_ = 0, small_ = 0;
  Eigen::Vector3d origin_;
  double coordinate_ = 0;  // the largest, in local lengths
  bool collapsed_ = false;
};

}  // namespace batten::internal
