// SPDX-License-Identifier: MIT
// Terms of the user in other coordinates than those of the optimiser.
#pragma once

#include <Eigen/Core>

#include "batten/fitting/residual_term.h"

namespace batten::internal {

// The terms as they are when the control points they are handed are moved by `offset`, which has
// the dimension of the control points. Nulls stay.
ResidualTerms MovedTerms(ResidualTerms terms, const Eigen::VectorXd& offset);

}  // namespace batten::internal
