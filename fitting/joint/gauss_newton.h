// SPDX-License-Identifier: MIT
// Gauss-Newton descent of the joint stage where only control points are free. Used by the joint
// stage only.
#pragma once

#include <vector>

#include "fitting/joint/eliminated_problem.h"
#include "fitting/joint/joint_options.h"
#include "fitting/joint/joint_result.h"

namespace batten::internal {

// Lowers the cost of the cells, which have been projected, and keeps the record in `result`: Gauss-
// Newton steps damped by the point-distance matrix, less where the cost fell as the model promised,
// more where it did not; then the step is tried again from the same sums. `fixed` blocks stay.
// Leaves the unknowns at the best state; the cells may be elsewhere. [Nielsen 1999]
void DescendJointly(EliminatedProblem& cells,
                    const std::vector<bool>& fixed,
                    const JointOptions& options,
                    ThreadPool& pool,
                    JointResult& result);

}  // namespace batten::internal
