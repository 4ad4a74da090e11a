// SPDX-License-Identifier: MIT
// The points of a fit as its estimate weighed them: offsets, weights and the loss's slopes.
#pragma once

#include <Eigen/Core>

#include "batten/fitting/curve_options.h"
#include "batten/fitting/point_cloud.h"
#include "batten/fitting/surface_options.h"

namespace batten::internal {

// Of the points fitted to, in the cloud's order.
struct WeighedPoints {
  Eigen::Matrix2Xd parameters;
  Eigen::MatrixXd pulls;    // ψ across the shape: one row, or three for curves in space
  int components = 1;       // degrees of freedom of a pull: 2 for curves in space
  Eigen::VectorXd weights;  // of the points themselves
  Eigen::VectorXd pulled;   // ψ(d)/d, the weight the loss left each
  double slope = 1;         // mean of ψ'

  Eigen::Index size() const { return weights.size(); }
};
WeighedPoints Weigh(const SurfaceFit& fit, const PointCloud& cloud);
template <int Dim>
WeighedPoints Weigh(const CurveFit<Dim>& fit, const PointCloud& cloud);

extern template WeighedPoints Weigh(const CurveFit<2>&, const PointCloud&);
extern template WeighedPoints Weigh(const CurveFit<3>&, const PointCloud&);

}  // namespace batten::internal
