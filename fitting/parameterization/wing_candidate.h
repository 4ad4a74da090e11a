// SPDX-License-Identifier: MIT
// Base of thin closed sections with a sharp edge: wings, blades, fins, struts.
#pragma once

#include "fitting/parameterization/base_attempt.h"

namespace batten::internal {

// The section laid as one sheet round its nose, which closes at its sharp edge (LayWing). It takes
// in points that are outliers by their neighbours, since at a thin edge these are those of the
// other side; the surface judges them.
BaseMethod WingCandidate(const BaseInput& input);

}  // namespace batten::internal
