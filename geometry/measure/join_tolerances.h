// SPDX-License-Identifier: MIT
// What the tests of joins of curves and of surfaces share.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <string>

#include "batten/geometry/join_options.h"
#include "batten/geometry/spline_basis.h"

namespace batten::internal {

// The scale of two shapes that meet and the tolerances that follow from it.
class JoinScale {
 public:
  // Throws std::invalid_argument, `function` first, unless all tolerances are positive.
  template <typename Shape>
  JoinScale(const Shape& first,
            const Shape& second,
            const JoinOptions& options,
            const std::string& function)
      : options_(options) {
    for (const Shape* shape : {&first, &second}) {
      const auto& points = shape->control_points();
      size_ = std::max(size_, (points.rowwise().maxCoeff() - points.rowwise().minCoeff()).norm());
      coordinate_ = std::max(coordinate_, points.cwiseAbs().maxCoeff());
    }
    SetPosition(function);
  }

  double size() const { return size_; }          // the larger diagonal of the boxes
  double position() const { return position_; }  // the widest gap allowed

  // How large the rounding of what is computed from the coordinates may be: some units in the last
  // place of the largest.
  double rounding() const;

  // Equal derivatives: to derivative_tolerance of the longest of both and `least`, and to rounding.
  bool Equal(const Eigen::Vector3d& a,
             const Eigen::Vector3d& b,
             double least,
             double rounding) const;

  bool Smooth(double angle) const { return angle <= options_.angle_tolerance; }

  // Whether a gap between curvatures, the larger of which is given, is none.
  bool EquallyCurved(double gap, double curvature) const;

 private:
  void SetPosition(const std::string& function);

  const JoinOptions options_;
  double size_ = 0, coordinate_ = 0, position_ = 0;
};

// Degree over width of the span at a parameter: what every derivative multiplies rounding by.
double Steepness(const SplineBasis& basis, double u);

}  // namespace batten::internal
