// SPDX-License-Identifier: MIT
// The handles of a solid of exact faces.
#pragma once

#include "batten/fitting/trimmed_solid.h"

namespace batten::internal {

// How many handles its shells have together: of a tube one, of a plate with six bores six. By
// Euler's formula, for loops that are closed and do not cross.
int GenusOf(const TrimmedSolid& solid);

}  // namespace batten::internal
