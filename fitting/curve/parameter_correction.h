// SPDX-License-Identifier: MIT
// Parameter correction of curves: every datum's parameter moves to its local foot point.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "batten/fitting/fitting_problem.h"
#include "batten/fitting/solve_linear.h"
#include "fitting/curve/distance_minimisation.h"

namespace batten::internal {

// Steps of a fit whose parameters shall come near their foot points: few, so as not to follow
// noise.
inline constexpr int kFootPointSteps = 2;

// Rounds of distance minimisation where nobody asked for its minimum.
inline constexpr int kRoundsOfDistance = 20;

// Points and unit tangents of the curve with coefficients d × n (d = 2 or 3) at the problem's
// parameters.
struct CurveSamples {
  Eigen::MatrixXd points;    // d × m: of the curve
  Eigen::MatrixXd tangents;  // d × m: of length 1, zero where the curve stands still
};

CurveSamples CurveAt(const FittingProblem& problem,
                     const Eigen::MatrixXd& coefficients,
                     ThreadPool& pool);

// The number of inflections (sign changes of the curvature) of a plane curve, from 16 samples a
// span; 0 in space.
int Inflections(const SplineBasis& basis, const Eigen::MatrixXd& coefficients);

// The component of each column orthogonal to its unit tangent.
Eigen::MatrixXd Across(Eigen::MatrixXd columns, const Eigen::MatrixXd& tangents);

// Returns the problem with every parameter moved to its local foot point; those of an open curve
// are then stretched over the domain where they leave its ends empty. About 10 million a second and
// core. Data of the `anchored` indices stay: those at a corner, which keep it in its place.
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

// Solves, then `steps` times at most moves the parameters to the foot points and solves again. Data
// are in order along the curve; a step that would reverse that order, because the curve is still
// far from them, is not taken.
CorrectedFit FitWithCorrection(const FittingProblem& problem,
                               int steps,
                               ThreadPool& pool,
                               const std::vector<Eigen::Index>& anchored = {});

// Refines the fit by point, tangent or squared distance minimisation (distance_minimisation.h), so
// that it follows the points as closely as the basis can; `steps` counts its rounds. An open curve
// that has become longer than its data is cut to them, its domain the same; where the cut would
// exceed an end span, the fit comes back unchanged.
CorrectedFit AtMinimumDistance(const CorrectedFit& fit,
                               const DistanceMinimisationOptions& options,
                               ThreadPool& pool);

}  // namespace batten::internal
