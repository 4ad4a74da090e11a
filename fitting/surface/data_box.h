// SPDX-License-Identifier: MIT
// Solutions that stay within the box of their data.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "batten/fitting/fitting_problem.h"
#include "batten/fitting/solve_linear.h"
#include "batten/geometry/nurbs_surface.h"
#include "batten/geometry/thread_pool.h"

namespace batten::internal {

// Holds a surface that leaves the box of its data (along their principal axes), grown by a fifth
// of the data's diagonal (heights above the plane through them: by 7 %), in corners and gaps
// where the data do not determine it: places outside are data from then on, at the nearest point of
// the box grown by nine tenths of that, with weights that grow from round to round; what is left
// after six rounds fairness pulls in. Returns nothing where the solution stays in the box, which
// its coefficients tell at once in most fits. Data are heights or points; the box is grown by
// `grown` times as much. O(coefficients), and a solve for each round.
std::optional<LinearSolution> HeldInBox(const FittingProblem& problem,
                                        const LinearSolution& solution,
                                        ThreadPool& pool,
                                        double grown = 1);

// How far a surface in space leaves the box of points (along their principal axes), over its
// diagonal; zero up to a fifth. O(control points).
double BeyondBox(const NurbsSurface& surface, const Eigen::Matrix3Xd& points);

}  // namespace batten::internal
