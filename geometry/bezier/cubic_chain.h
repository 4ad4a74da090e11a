// SPDX-License-Identifier: MIT
// Bézier cubics joined as one spline. Internal to geometry.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <utility>
#include <vector>

#include "batten/geometry/nurbs_curve.h"

namespace batten::internal {

// Cubics one after another as a spline; a new one may be begun.
template <int Dim>
class CubicChain {
 public:
  using Points = Eigen::Matrix<double, Dim, 4>;

  // `knot` is the multiplicity of the knot between this and the cubic before.
  void Add(const Points& cubic, double from, double to, int multiplicity) {
    if (points_.empty()) {
      knots_.assign(4, from);
      points_.push_back(cubic.col(0));
    } else {
      knots_.insert(knots_.end(), multiplicity, from);
      if (multiplicity == 3) points_.push_back(last_);
    }
    points_.push_back(cubic.col(1));
    points_.push_back(cubic.col(2));
    last_ = cubic.col(3);
    end_ = to;
  }
  bool empty() const { return points_.empty(); }
  NurbsCurve<Dim> Take() {
    knots_.insert(knots_.end(), 4, end_);
    points_.push_back(last_);
    Eigen::Matrix<double, Dim, Eigen::Dynamic> points(Dim, points_.size());
    for (std::size_t k = 0; k < points_.size(); ++k) {
      points.col(static_cast<Eigen::Index>(k)) = points_[k];
    }
    points_.clear();
    return NurbsCurve<Dim>(SplineBasis(3, std::move(knots_)), std::move(points));
  }

 private:
  std::vector<double> knots_;
  std::vector<Eigen::Matrix<double, Dim, 1>> points_;
  Eigen::Matrix<double, Dim, 1> last_;
  double end_ = 0;
};

}  // namespace batten::internal
