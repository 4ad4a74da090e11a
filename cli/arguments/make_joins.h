// SPDX-License-Identifier: MIT
// batten make blend and fill: what joins two shapes smoothly, and how well it does.
#pragma once

#include "cli/arguments/make_kind.h"

namespace batten::internal {

MakeKind BlendKind();
MakeKind FillKind();

}  // namespace batten::internal
