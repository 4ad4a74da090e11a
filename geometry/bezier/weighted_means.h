// SPDX-License-Identifier: MIT
// Means of weighted control points. Internal to geometry.
#pragma once

#include <Eigen/Core>

namespace batten::internal {

// Control points in columns, Euclidean, with their weights.
struct WeightedPoints {
  Eigen::MatrixXd points;
  Eigen::VectorXd weights;
};

// For each column c of `coefficients` (all ≥ 0, sum 1) the point Σ c_i w_i P_i / Σ c_i w_i with
// weight Σ c_i w_i; computed from one of the points and the differences from it, so that points
// that coincide give the same point bit by bit. Where all weights are equal, so are the new ones.
WeightedPoints WeightedMeans(const WeightedPoints& points, const Eigen::MatrixXd& coefficients);

}  // namespace batten::internal
