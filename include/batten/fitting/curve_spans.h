// SPDX-License-Identifier: MIT
// Number of knot spans of a curve by cross-validation, and refinement to a tolerance.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "batten/fitting/curve_options.h"
#include "batten/fitting/fit_report.h"
#include "batten/fitting/fitting_problem.h"
#include "batten/fitting/progress.h"
#include "batten/fitting/solve_linear.h"
#include "batten/geometry/nurbs_curve.h"

namespace batten {

// The B-spline curve of dimension 2 or 3 with the coefficients (d × n) over a basis.
template <int Dim>
NurbsCurve<Dim> CurveOf(const SplineBasis& basis, const Eigen::MatrixXd& coefficients) {
  return NurbsCurve<Dim>(basis, coefficients);
}

// The distance of every datum of a curve's problem, by kParameter or kPoint. Never negative.
Eigen::VectorXd CurveDistances(const FittingProblem& problem,
                               const Eigen::MatrixXd& coefficients,
                               CurveDistance distance,
                               ThreadPool& pool);

struct SpanChoice {
  FittingProblem problem;
  std::vector<RoundSummary> rounds;
};

// Chooses the number of equal spans of least generalised cross-validation score N·RSS/(N − 1.4 n)²,
// over a ladder from one span to as many as leave two data to a control point, then around the best
// of it. Weights must have the scale of counts (mean about 1). O(m) for each of some 40 rungs.
// [Craven & Wahba 1979; the factor 1.4: Kim & Gu 2004]
SpanChoice ChooseSpans(const FittingProblem& problem,
                       int max_control_points,
                       ThreadPool& pool,
                       const Progress& progress = {});

struct SpanRefineOptions {
  double tolerance = 0;  // distance in the data's units, > 0
  CurveDistance distance = CurveDistance::kPoint;
  double noise = 0;  // standard deviation; data that are exact against the tolerance carry one
                     // control point each, others one for every 2.1
  int max_control_points = 2000;
};

struct SpanRefinement {
  FittingProblem problem;   // over the best basis seen
  LinearSolution solution;  // on it
  Termination termination;  // tolerance_reached, max_control_points or cancelled
  std::vector<RoundSummary> rounds;
};

// Halves, in rounds of solving and measuring, every span that holds a datum out of tolerance, worst
// first, as far as the data carry it; data of weight zero don't count. The best has the fewest data
// out of tolerance, then the least rms.
SpanRefinement RefineSpans(const FittingProblem& problem,
                           const SpanRefineOptions& options,
                           ThreadPool& pool,
                           const Progress& progress = {});

}  // namespace batten
