// SPDX-License-Identifier: MIT
// Operations of `batten edit` that change a shape by hand.
#pragma once

#include "cli/arguments/edit_values.h"

namespace batten::internal {

// Each throws UsageError, or std::invalid_argument of the library, where it is impossible for the
// shape.
EditOutcome SetWeight(const EditOperation& operation, const Geometry& shape);
EditOutcome PullPoint(const EditOperation& operation, const Geometry& shape);
EditOutcome MovePoint(const EditOperation& operation, const Geometry& shape);
EditOutcome MoveTargets(const EditOperation& operation, const Geometry& shape);
EditOutcome WarpRegion(const EditOperation& operation, const Geometry& shape);
EditOutcome FlattenRegion(const EditOperation& operation, const Geometry& shape);
EditOutcome BendShape(const EditOperation& operation, const Geometry& shape);

}  // namespace batten::internal
