// SPDX-License-Identifier: MIT
// Block means and thinning of points in order along a curve.
#pragma once

#include <Eigen/Core>

#include "batten/fitting/fitting_problem.h"

namespace batten::internal {

struct RowMeans {
  Eigen::Matrix3Xd points;
  Eigen::VectorXd parameters;  // increasing
};

// The points by increasing parameters, those of equal parameters replaced by their mean.
RowMeans IncreasingRow(const Eigen::Matrix3Xd& points, const Eigen::VectorXd& parameters);

// The ratio of the row's length to its parameters' range, by means of a few hundred blocks, which
// noise hardly lengthens. Points are in order.
double LengthPerParameter(const Eigen::Matrix3Xd& points, const Eigen::VectorXd& parameters);

// Returns a curve's problem with its data, in order, replaced by the weighted means of `count`
// blocks of about equally many; fewer where there are fewer data.
FittingProblem MeansOfRows(const FittingProblem& problem, Eigen::Index count);

// The problem with `count` of its data, at even steps of their order; all where there are fewer.
FittingProblem EveryFewData(const FittingProblem& problem, Eigen::Index count);

}  // namespace batten::internal
