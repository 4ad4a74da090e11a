// SPDX-License-Identifier: MIT
// batten make conic: arcs of conics by what is known of them.
#pragma once

#include "cli/arguments/make_kind.h"

namespace batten::internal {

MakeKind ConicKind();

}  // namespace batten::internal
