// SPDX-License-Identifier: MIT
// Chooses the smoothing weight of a least-squares problem from the data: cross-validation or a
// known noise.
#pragma once

#include "batten/fitting/fitting_problem.h"
#include "batten/fitting/progress.h"

namespace batten::internal {

// The effective degrees of freedom of a smoothed solution, tr((A + λP)⁻¹A): between the dimension
// of the fairness energy's null space and the number of control points. Exact up to 256 control
// points, beyond by 16 to 64 random probes of a fixed seed (Hutchinson 1990), to about a hundredth.
// O(m) once, and one factorisation.
double EffectiveFreedom(const FittingProblem& problem, ThreadPool& pool);

// The smoothing with the least generalised cross-validation score N·RSS/(N − tr H)², tr H the
// effective freedom, searched over 1e-12 … 1e9 by steps of a factor ten, then to a tenth of that.
// It does not depend on the data's unit. [Craven & Wahba 1979]
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
