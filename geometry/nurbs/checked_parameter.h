// SPDX-License-Identifier: MIT
// Parameters that an operation refuses instead of moving them into the domain.
#pragma once

#include <string>

#include "batten/geometry/spline_basis.h"

namespace batten::internal {

// The parameter of the domain that stands for `value`: itself inside the closed domain, whole
// periods away over a periodic basis. Otherwise throws std::invalid_argument, for example
// "InsertKnot: u = 1.5 is outside the domain [0, 1]"; `function` and `name` are its first words.
double CheckedParameter(const SplineBasis& basis,
                        double value,
                        const std::string& function,
                        const std::string& name);

}  // namespace batten::internal
