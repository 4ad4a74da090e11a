// SPDX-License-Identifier: MIT
// Whether points fill space, a plane, a line or a place.
#pragma once

#include <Eigen/Core>
#include <Eigen/Eigenvalues>

namespace batten {

// The number of directions (0 … d) in which columns spread by more than 1e-6 of the widest spread:
// squares of less drown in rounding. O(m).
inline int PointRank(const Eigen::MatrixXd& points) {
  constexpr double kFlat = 1e-6;
  if (points.cols() == 0) return 0;
  const Eigen::VectorXd mean = points.rowwise().mean();
  const double size = (points.colwise() - mean).cwiseAbs().maxCoeff();
  if (!(size > 0)) return 0;
  const Eigen::MatrixXd scaled = (points.colwise() - mean) / size;
  const Eigen::VectorXd spreads = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(
                                      scaled * scaled.transpose(), Eigen::EigenvaluesOnly)
                                      .eigenvalues();
  return static_cast<int>((spreads.array() > kFlat * kFlat * spreads.maxCoeff()).count());
}

}  // namespace batten
