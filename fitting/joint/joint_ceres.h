// SPDX-License-Identifier: MIT
// Minimisation by Ceres in the joint stage, for all free variables and the user's terms. Used by
// the joint stage only.
#pragma once

#include <memory>
#include <vector>

#include "fitting/joint/eliminated_problem.h"
#include "fitting/joint/joint_options.h"
#include "fitting/joint/joint_result.h"
#include "fitting/joint/term_cost.h"

namespace batten::internal {

using JointTerms = std::vector<std::unique_ptr<TermCost>>;

// Lowers the cost of the cells and the squares of the terms, and keeps the record in `result`.
// `fixed` blocks stay. Leaves the unknowns at the best state; the cells may be elsewhere.
void MinimiseByCeres(EliminatedProblem& cells,
                     const std::vector<bool>& fixed,
                     JointTerms terms,
                     const JointOptions& options,
                     JointResult& result);

}  // namespace batten::internal
