// SPDX-License-Identifier: MIT
// Removal of the knot lines of a fitted surface that the data do not need.
#pragma once

#include <functional>
#include <limits>
#include <vector>

#include "batten/fitting/fitting_problem.h"
#include "batten/fitting/solve_linear.h"

namespace batten::internal {

// The jump of the p-th derivative at an inner knot, or a periodic seam, of multiplicity one, as a
// form of length one in the distinct coefficients; `rows` are those of the basis' coefficients.
Eigen::VectorXd TopDerivativeJump(const SplineBasis& basis,
                                  const std::vector<int>& rows,
                                  double knot);

// Decides whether the surface with fewer knot lines may replace the one before it: problem and
// solution are those with fewer lines.
using AcceptRemoval = std::function<bool(const FittingProblem&, const LinearSolution&)>;

// Removes inner knot lines, the least worth first and many at a time, as long as `accept_removal`
// agrees; it is asked after every removal that is tried, and remembers for itself what it compares
// with. The worth of a line is the rise of the weighted sum of squares without it, per control
// point it carries; lines worth more than `most` are left alone. Their worth is estimated as if the
// density of the points were a product of one in u and one in v. Lines of a knot of multiplicity
// above one, and those of a periodic direction, stay. O((m + n · min(n_u, n_v)²) · log(lines)) as a
// rule. Throws std::invalid_argument for a curve's problem.
FittingProblem RemoveKnotLines(const FittingProblem& problem,
                               const AcceptRemoval& accept_removal,
                               ThreadPool& pool,
                               double most = std::numeric_limits<double>::infinity());

// Removes the knot lines whose removal lowers the score N·RSS/(N − n)² of generalised
// cross-validation. Weights must have the scale of counts (mean about 1). Noise that neighbours
// share keeps lines, but none are added. Throws std::invalid_argument for a curve's problem.
FittingProblem PruneKnotLines(const FittingProblem& problem, ThreadPool& pool);

// Prunes as PruneKnotLines; where a quarter of the control points were removed, the shape has
// detail in a part of the sheet only, and finer grids, pruned likewise, are tried as long as the
// score falls. The problem's bases are those of FittingBasis that ChooseGrid chose. Never more
// control points to begin with than the limit, or than one for three points. Throws as
// PruneKnotLines does.
FittingProblem RefineAndPruneKnotLines(const FittingProblem& problem,
                                       int max_control_points,
                                       ThreadPool& pool);

}  // namespace batten::internal
