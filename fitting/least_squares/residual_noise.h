// SPDX-License-Identifier: MIT
// Noise variance of residuals by differences of neighbours.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace batten::internal {

// Estimates noise from data ordered so that successors are neighbours on the shape: along a curve
// by parameter, over a surface along a Z-order curve. A smooth shape's systematic error is nearly
// the same at neighbours, noise is not, so half the mean squared difference between each residual
// and the next four is the variance of the noise, whatever else the residuals hold. Its relative
// error against the mean square of white residuals is 1/(2√m). [von Neumann 1941; Gasser, Sroka &
// Jennen-Steinmetz 1986]
class ResidualNoise {
 public:
  // One column (u, v) for each datum; for curves the second row is constant. O(m log m).
  explicit ResidualNoise(const Eigen::Matrix2Xd& parameters);

  // ½ of the mean of |r_i − r_j|² over neighbours; `residuals` has one column for each datum,
  // `weights` (empty: ones) are relative inverse variances: the result is that of weight 1. Zero
  // with fewer than two data that count. O(m).
  double Variance(const Eigen::MatrixXd& residuals, const Eigen::VectorXd& weights) const;

 private:
  std::vector<Eigen::Index> order_;
};

}  // namespace batten::internal
