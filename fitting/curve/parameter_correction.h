// SPDX-License-Identifier: MIT
// Every datum of a curve's problem moved to its foot point, near where it is.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "batten/fitting/fitting_problem.h"
#include "batten/fitting/solve_linear.h"
#include "fitting/curve/distance_minimisation.h"

namespace batten::internal {

// What the coefficients (d × n, d = 2 or 3) are at the problem's parameters, and across the curve.
struct CurveSamples {
  Eigen::MatrixXd points;    // d × m: of the curve
  Eigen::MatrixXd tangents;  // d × m: of length 1, zero where the curve stands still
};

CurveSamples CurveAt(const FittingProblem& problem,
                     const Eigen::MatrixXd& coefficients,
                     ThreadPool& pool);

// How often the curvature of a plane curve changes its sign, by 16 samples a span; 0 in space.
int Inflections(const SplineBasis& basis, const Eigen::MatrixXd& coefficients);

// The part of each column across the unit tangents.
Eigen::MatrixXd Across(Eigen::MatrixXd columns, const Eigen::MatrixXd& tangents);

// The problem with every parameter at the local foot point below it, those of an open curve then
// stretched over the domain where they leave its ends empty. About 10 million a second and core.
// Data of the `anchored` indices stay: those at a corner, which keep it in its place.
FittingProblem CorrectedParameters(const FittingProblem& problem,
                                   const Eigen::MatrixXd& coefficients,
                                   ThreadPool& pool,
                                   const std::vector<Eigen::Index>& anchored = {});

// The distance of every datum from the curve at its parameter, across the curve only where
// `across` is set; zero for data without weight.
Eigen::VectorXd DistancesAt(const FittingProblem& problem,
                            const Eigen::MatrixXd& coefficients,
                            bool across,
                            ThreadPool& pool);

struct CorrectedFit {
  FittingProblem problem;
  LinearSolution solution;
  int steps = 0;  // taken
};

// Solves, then `steps` times at most moves the parameters to the feet and solves again. Data are in
// order along the curve; a step that would turn that order round, because the curve is still far
// from them, is not taken.
CorrectedFit FitWithCorrection(const FittingProblem& problem,
                               int steps,
                               ThreadPool& pool,
                               const std::vector<Eigen::Index>& anchored = {});

// The fit brought down by the distances of a model (distance_minimisation.h), which follows the
// points as closely as the basis can; `steps` counts its rounds. An open curve that has become
// longer than its data is cut to them, its domain the same; by more than an end span, and the fit
// comes back as it was.
CorrectedFit AtMinimumDistance(const CorrectedFit& fit,
                               const DistanceMinimisationOptions& options,
                               ThreadPool& pool);

}  // namespace batten::internal
