// SPDX-License-Identifier: MIT
// The affine rank of a point set: 3 for space, 2 a plane, 1 a line, 0 a single place.
#pragma once

#include <Eigen/Core>

#include "fitting/core/rounding.h"
#include "geometry/numeric/dense_solvers.h"

namespace batten::internal {

// The number of principal directions (0 … d) in which columns spread by more than 1e-6 of the
// widest spread; squares of smaller spreads are lost in rounding. O(m).
inline int PointRank(const Eigen::Ref<const Eigen::MatrixXd>& points) {
  if (points.cols() == 0) return 0;
  const Eigen::VectorXd low = points.rowwise().minCoeff(), high = points.rowwise().maxCoeff(),
                        middle = low + (high - low) / 2;
  const double size = (high - middle).maxCoeff();
  if (!(size > 0)) return 0;
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(points.rows()), p(points.rows());
  Eigen::MatrixXd scatter = Eigen::MatrixXd::Zero(points.rows(), points.rows());
  for (Eigen::Index k = 0; k < points.cols(); ++k) {
    p = (points.col(k) - middle) / size;
    sum += p;
    scatter.noalias() += p * p.transpose();
  }
  scatter -= sum * sum.transpose() / static_cast<double>(points.cols());
  const Eigen::VectorXd spreads = EigenOf(scatter).values;
  return static_cast<int>((spreads.array() > kRelativeRounding * spreads.maxCoeff()).count());
}

}  // namespace batten::internal
