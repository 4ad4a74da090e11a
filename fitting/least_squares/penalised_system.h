// SPDX-License-Identifier: MIT
// The penalised normal equations (A + λP) of a fitting problem, assembled once and solved for any
// smoothing.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "batten/fitting/fitting_problem.h"
#include "fitting/least_squares/fairness.h"
#include "fitting/least_squares/normal_equations.h"
#include "fitting/linear/block_banded_matrix.h"
#include "fitting/linear/tied_system.h"

namespace batten::internal {

// The normal matrix A of a problem's data and the form P of its energy; the longer direction of the
// net is outside, so that the band stays narrow. A jitter on the diagonal, a few units in the last
// place, keeps a semidefinite matrix positive definite under rounding.
class PenalisedSystem {
 public:
  // Gathers the data. O(m (2p+1)(2q+1)).
  PenalisedSystem(const FittingProblem& problem, ThreadPool& pool);

  // The same system from bases (v null: a curve) with one parameter a point in each direction.
  PenalisedSystem(const SplineBasis& basis_u,
                  const SplineBasis* basis_v,
                  const Eigen::VectorXd& u,
                  const Eigen::VectorXd& v,
                  const Eigen::MatrixXd& values,
                  const Eigen::VectorXd& weights,
                  FairnessEnergy energy,
                  ThreadPool& pool);

  struct Solution {
    TiedSystem factor;     // of A + λP and the jitter under the problem's conditions
    Eigen::MatrixXd rows;  // unknowns × d
    double lambda;
    bool raised;                  // the matrix was singular: the smoothing is not the one asked for
    double residual_squares = 0;  // Σ w |S − z|², as a difference of sums over the data
  };

  // Minimises the penalised sum under the problem's conditions (poles), which are met by
  // elimination. Where the matrix is singular, the smoothing is raised tenfold at a time; throws
  // std::invalid_argument where that does not help. A pool, where given, helps with large nets. O(n
  // · min(n_u, n_v)²).
  Solution Solve(double smoothing, ThreadPool* pool = nullptr) const;

  // A + smoothing · tr(A)/tr(P) · P and so many jitters, not factored.
  BlockBandedMatrix Matrix(double smoothing, double jitters) const;

  // Whether the system, factored at a smoothing with this least pivot, is not singular: fairness
  // determines what it can, or the pivot is clearly above that of a coefficient that only the
  // jitter determines, by `margin` times as much as Solve asks for.
  bool Determines(double smoothing, double least_pivot, double margin = 1) const;

  // Where it is singular, more is tried so often: jitters, of which high degrees need more than the
  // rounding unit, and smoothing.
  static constexpr int kAttempts = 16;
  static double JittersOf(int attempt);
  static double Raised(double smoothing);

  double Lambda(double smoothing) const { return smoothing * unit_; }
  double squares() const { return equations_.squares(); }  // Σ w |z|²
  const Eigen::MatrixXd& rhs() const { return equations_.rhs(); }
  int unknowns() const { return static_cast<int>(equations_.rhs().rows()); }

  // The energy Σ cᵀPc over the columns c.
  double Roughness(const Eigen::MatrixXd& rows) const;

  // The solver's rows as the coefficients d × (n_u · n_v) of the problem, repeated ones too, v
  // fastest; and the row of each coefficient.
  Eigen::MatrixXd Net(const Eigen::MatrixXd& rows) const;
  Eigen::Index RowOf(Eigen::Index coefficient) const;

 private:
  // `points` with the parameters of u and v.
  PenalisedSystem(const SplineBasis& basis_u,
                  const SplineBasis* basis_v,
                  const PointRows& points,
                  FairnessEnergy energy,
                  ThreadPool& pool);

  Eigen::MatrixXd InOuterOrder(const Eigen::MatrixXd& rows) const;

  bool u_outside_;
  SplineBasis outer_;
  std::optional<SplineBasis> inner_;
  std::vector<int> outer_rows_, inner_rows_;
  Eigen::Index inner_distinct_;
  NormalEquations equations_;
  FairnessForm fairness_;
  double unit_, jitter_;  // tr(A)/tr(P)
  NetTies ties_;          // of the rows at poles
};

}  // namespace batten::internal
