// SPDX-License-Identifier: MIT
// What the operations of `batten edit` do to a shape.
#pragma once

#include "batten/io/geometry_types.h"
#include "cli/arguments/edit_values.h"

namespace batten::internal {

// Applies one operation. Throws UsageError naming the operation as typed, the value and the rule
// where it is impossible for this shape.
EditOutcome ApplyEdit(const EditOperation& operation, const Geometry& shape);

// An operation that makes one shape of all there are, and whether it is one.
Geometry ApplyToAll(const EditOperation& operation, const std::vector<Geometry>& shapes);
bool TakesAll(const EditOperation& operation);

// Whether the operation cuts shapes into pieces that are files of their own.
bool CutsIntoPieces(const EditOperation& operation);

}  // namespace batten::internal
