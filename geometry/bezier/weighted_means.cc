// SPDX-License-Identifier: MIT
#include "geometry/bezier/weighted_means.h"

namespace batten::internal {

WeightedPoints WeightedMeans(const WeightedPoints& given, const Eigen::MatrixXd& coefficients) {
  const bool equal = (given.weights.array() == given.weights[0]).all();
  WeightedPoints result{Eigen::MatrixXd(given.points.rows(), coefficients.cols()),
                        Eigen::VectorXd::Constant(coefficients.cols(), given.weights[0])};
  for (Eigen::Index k = 0; k < coefficients.cols(); ++k) {
    Eigen::Index largest = 0;
    coefficients.col(k).maxCoeff(&largest);
    Eigen::VectorXd scaled = coefficients.col(k);
    if (!equal) scaled.array() *= given.weights.array();
    const double sum = scaled.sum();
    result.points.col(k) = given.points.col(largest) +
                           (given.points.colwise() - given.points.col(largest)) * (scaled / sum);
    if (!equal) result.weights[k] = sum;
  }
  return result;
}

}  // namespace batten::internal
