// SPDX-License-Identifier: MIT
// Detection of overshoot of a fitted curve between its data.
#pragma once

#include <Eigen/Core>

#include "batten/fitting/fitting_problem.h"

namespace batten::internal {

// Whether the curve overshoots between its data, which no residual shows: between two data with
// weight that follow one another along the curve, some place of it lies farther from their chord
// than that is long, ten standard deviations of the noise and a hundredth of the data's size added;
// or lies outside of their box by a quarter of its diagonal. 16 samples a span; weights of the
// curve may be empty. O(m + samples).
bool HasOvershoot(const FittingProblem& problem,
                  const Eigen::MatrixXd& control_points,
                  const Eigen::VectorXd& weights,
                  double noise);

// Whether a polynomial curve runs back between its data, as in a cusp or a loop: against the chord
// of the data beside it by more than a hundredth of that and three standard deviations of the
// noise, but where a corner (a knot of multiplicity p) lies between them. Curves may well do so,
// which parameters of the data can show; one whose parameters are its foot points must not begin
// to. 16 samples a span, O(m
// + samples).
bool TurnsBack(const FittingProblem& problem, const Eigen::MatrixXd& control_points, double noise);

// The diagonal of the bounding box of a curve, from 16 samples a span.
double SampledSize(const SplineBasis& basis,
                   const Eigen::MatrixXd& control_points,
                   const Eigen::VectorXd& weights);

}  // namespace batten::internal
