// SPDX-License-Identifier: MIT
// The line where evenly spread noisy points end.
#pragma once

#include <Eigen/Core>
#include <optional>

namespace batten::internal {

// Points of even density up to an end, blurred by noise.
struct EndingPoints {
  Eigen::MatrixXd along;  // m × n: values of n functions that the end is a sum of, at each point
  Eigen::VectorXd reach;  // across the end, larger outwards; lengths
  Eigen::VectorXd place;  // along the end, 0 … 1, for a first guess
};

// The least window, in noises: wide against them, narrow against the shape.
inline constexpr double kEndWindowInNoises = 12;

// Finds coefficients of the end as a sum of the functions: the maximum likelihood of the points
// within `window` of it under the density Φ((end − reach)/noise), where extremes would be pulled
// out by noise and in by spacing. The error is about √(noise · spacing across) over the root of
// points per function. None where points are too few, or the search ends far from its start.
// O(m n²) a step, some dozens.
std::optional<Eigen::VectorXd> EndOfPoints(const EndingPoints& points, double noise, double window);

}  // namespace batten::internal
