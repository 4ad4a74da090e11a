// SPDX-License-Identifier: MIT
// What an operation of `batten edit` is given, as a shape takes it, and what comes of it.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "batten/io/geometry_types.h"
#include "cli/arguments/edit_syntax.h"

namespace batten::internal {

struct EditOutcome {
  std::vector<Geometry> pieces;  // one, but for split, decompose, cut and trim
  std::string shortfall;         // how an operation fell short of what was asked; or empty
};

inline EditOutcome One(Geometry shape) { return {{std::move(shape)}, ""}; }

// Throws UsageError unless the key holds `count` numbers: one for each parameter of the shape.
void RequireCount(const EditOperation& operation, const std::string& key, size_t count);

// The numbers of a key as so many points of the shape's space (Dim × count); those of a plane curve
// may have a third number that is zero. Throws UsageError where there are not as many.
template <int Dim>
Eigen::Matrix<double, Dim, Eigen::Dynamic> PointsOf(const EditOperation& operation,
                                                    const std::string& key,
                                                    size_t count);
template <int Dim>
Eigen::Matrix<double, Dim, 1> PointOf(const EditOperation& operation, const std::string& key) {
  return PointsOf<Dim>(operation, key, 1);
}

// What an operation that is to change nothing may move the shape by: 1e-10 of its size, and what
// its coordinates were rounded to where they are far from zero.
template <typename Shape>
double RoundingOf(const Shape& shape) {
  constexpr double kOfTheSize = 1e-10, kRoundings = 32;
  const auto& points = shape.control_points();
  const double size = (points.rowwise().maxCoeff() - points.rowwise().minCoeff()).norm();
  return std::max(
      kOfTheSize * size,
      kRoundings * std::numeric_limits<double>::epsilon() * points.cwiseAbs().maxCoeff());
}

}  // namespace batten::internal
