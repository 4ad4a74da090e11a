// SPDX-License-Identifier: MIT
// Linear equality constraints of a constrained surface: corners, points, normals.
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <string>
#include <vector>

#include "fitting/constraints/edge_rows.h"
#include "fitting/constraints/surface_constraints.h"

namespace batten::internal {

// A block of equations of one condition.
struct ConditionBlock {
  enum class Kind { kPlace, kNormal, kCornerPlane, kTwist };
  Kind kind;
  std::string name;
  Eigen::Index first, count;
  double length = 0;      // kCornerPlane: turns the last equation into the sine of an angle
  Eigen::Index from = 0;  // kPlace and kNormal: the point's index
};

// Equation k: direction_k · Σ x_c functional_f(c) + (unknowns)_k · t = right_k, with f the k-th of
// `functional` (none: −1), x_c the inner coarse control points and t the unknowns of the edges.
struct LinearConstraints {
  Eigen::SparseMatrix<double> functionals;  // n_u·n_v (coarse, v fastest) × functionals
  std::vector<int> functional;
  Eigen::Matrix3Xd directions;
  Eigen::MatrixXd unknowns;
  Eigen::VectorXd right, scales;  // scales: the size of an equation's left side
  std::vector<ConditionBlock> blocks;

  Eigen::Index count() const { return right.size(); }

  // The dense matrix of the equations: columns for x, y and z of `columns` (indices of coarse
  // control points), then t.
  Eigen::MatrixXd Rows(const std::vector<Eigen::Index>& columns) const;

  // The coarse control points that the equations involve.
  std::vector<Eigen::Index> Columns() const;
};

// Builds the constraints: corners first, then places and normals in order. Throws
// std::invalid_argument where a point is outside the domain or not finite, asks for nothing, or its
// normal is zero.
LinearConstraints ConditionsOf(const EdgeRows& edges,
                               const std::vector<FixedPoint>& points,
                               const Eigen::Vector3d& centre);

}  // namespace batten::internal
