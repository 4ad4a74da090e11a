// SPDX-License-Identifier: MIT
// Closed wings as known sheets, for the oracle.
#pragma once

#include "known_sheets.h"
#include "wings.h"

namespace batten::internal {

// u from the edge round the nose to the edge, v from root to tip. Little happens along the span:
// sides are such that cells of one shape are short round the section.
inline KnownSheet ClosedWing(const WingShape& shape) {
  const double around = WingSection(shape).length() * (1 + shape.taper) / 2;
  return {"closed wing", MapOf(shape), {around, around / 8}, {}};
}

}  // namespace batten::internal
