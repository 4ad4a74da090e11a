// SPDX-License-Identifier: MIT
// A spline least-squares problem at given parameters, and its linear solution.
#pragma once

#include <Eigen/Core>
#include <memory>

#include "batten/geometry/spline_basis.h"
#include "batten/geometry/thread_pool.h"

namespace batten {

// What is to be approximated: value k (d components) at parameters column k, with a weight.
struct FittingData {
  Eigen::Matrix2Xd parameters;  // (u, v)
  Eigen::MatrixXd values;       // d × m: heights over a base (d = 1) or points (d = 3)
  Eigen::VectorXd weights;      // empty: ones
};

// Bases, data and fairness: everything the control points follow from. Minimises
//   Σ w |S(u_k,v_k) − z_k|² + λ ∫∫ S_uu² + 2 S_uv² + S_vv²,   λ = smoothing · tr(A)/tr(P),
// A the normal matrix and P the fairness matrix, so that `smoothing` means the same at every number
// of points and in every unit. Data are shared between problems that differ in their bases.
class FittingProblem {
 public:
  // Throws std::invalid_argument unless sizes agree, parameters lie in the bases' domains,
  // everything is finite, weights are not negative and smoothing is not negative.
  FittingProblem(SplineBasis basis_u,
                 SplineBasis basis_v,
                 std::shared_ptr<const FittingData> data,
                 double smoothing);

  // The same data over other bases on the same domain; and with other weights.
  FittingProblem WithBases(SplineBasis basis_u, SplineBasis basis_v) const;
  FittingProblem WithWeights(Eigen::VectorXd weights) const;

  const SplineBasis& basis_u() const { return basis_u_; }
  const SplineBasis& basis_v() const { return basis_v_; }
  const FittingData& data() const { return *data_; }
  double smoothing() const { return smoothing_; }
  Eigen::Index size() const { return data_->parameters.cols(); }
  int unknowns() const { return basis_u_.size() * basis_v_.size(); }

 private:
  FittingProblem() = default;
  SplineBasis basis_u_{1, {0, 0, 1, 1}}, basis_v_{1, {0, 0, 1, 1}};
  std::shared_ptr<const FittingData> data_;
  double smoothing_ = 0;
};

struct LinearSolution {
  Eigen::MatrixXd coefficients;  // d × (n_u · n_v), v fastest
  double residual_squares = 0;   // Σ w |S − z|², to full accuracy even where it is tiny
  bool regularised = false;      // the matrix was singular: smoothing had to be raised
};

// Solves for the coefficients. Empty cells are carried by fairness; where that does not suffice,
// the smoothing is raised tenfold at a time and the solution says so. O(m + n · min(n_u, n_v)²).
LinearSolution SolveLinear(const FittingProblem& problem, ThreadPool& pool);

// Values of a coefficient net at the problem's parameters: d × m.
Eigen::MatrixXd EvaluateAt(const FittingProblem& problem,
                           const Eigen::MatrixXd& coefficients,
                           ThreadPool& pool);

}  // namespace batten
