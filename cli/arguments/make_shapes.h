// SPDX-License-Identifier: MIT
// The kinds of `batten make` that this version has: their flags, and the shapes made of them.
#pragma once

#include <vector>

#include "cli/arguments/make_kind.h"

namespace batten::internal {

const std::vector<MakeKind>& MakeKinds();

}  // namespace batten::internal
