// SPDX-License-Identifier: MIT
// The faces of a part as a table.
#pragma once

#include <string>

#include "batten/fitting/part_options.h"

namespace batten::internal {

// A row for each face and each relation.
std::string PartTable(const PartSummary& part);

}  // namespace batten::internal
