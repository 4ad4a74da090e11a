// SPDX-License-Identifier: MIT
// What is asked of sewing is checked. Not installed.
#pragma once

#include "batten/io/geometry_types.h"

namespace batten::internal {

// Throws std::invalid_argument where options.sew is negative or not finite, and for bodies that
// name what is no surface of the file, or a surface of another body.
void CheckSewing(const GeometryFile& file, const GeometryWriteOptions& options);

}  // namespace batten::internal
