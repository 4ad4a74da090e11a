// SPDX-License-Identifier: MIT
// The weight of fairness of a curve's or surface's least-squares problem, from the data.
#pragma once

#include "batten/fitting/fitting_problem.h"
#include "batten/fitting/progress.h"

namespace batten::internal {

// How many parameters of noise a smoothed solution has: tr((A + λP)⁻¹A), between the dimension of
// what fairness does not see and the number of control points. Exact up to 256 control points,
// beyond by 16 to 64 random probes of a fixed seed (Hutchinson 1990), to about a hundredth. O(m)
// once, and one factorisation.
double EffectiveFreedom(const FittingProblem& problem, ThreadPool& pool);

// The smoothing of least generalised cross-validation score N·RSS/(N − tr H)², tr H the effective
// freedom, over 1e-12 … 1e9 by steps of a factor ten, then to a tenth of that. The same in every
// unit. [Craven & Wahba 1979]
double SmoothingByCrossValidation(const FittingProblem& problem,
                                  ThreadPool& pool,
                                  const Progress& progress = {});

// The largest smoothing whose residuals are not above those that noise of this standard deviation
// in each of the data's coordinates (> 0) leaves: RSS ≤ d σ² (N − tr H). 1e-12 where even that
// leaves more. [Reinsch 1967; Wahba 1975]
double SmoothingFromNoise(const FittingProblem& problem,
                          double noise,
                          ThreadPool& pool,
                          const Progress& progress = {});

}  // namespace batten::internal
