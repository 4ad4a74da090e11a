// SPDX-License-Identifier: MIT
// Control rows are cut at parameters into clamped pieces, which share the control points where they
// meet bit by bit. split.h is the public face.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "geometry/editing/control_rows.h"

namespace batten::internal {

// The pieces below and above u. Throws std::invalid_argument, naming the parameter `name`, unless u
// is strictly inside the domain. [Piegl & Tiller 1997, §5.2]
std::pair<ControlRows, ControlRows> SplitRows(const ControlRows& rows,
                                              const std::string& name,
                                              double u);

// The piece over [a, b]. Throws std::invalid_argument unless lower ≤ a < b ≤ upper or, over a
// periodic basis, lower ≤ a < upper and a < b ≤ a + period.
ControlRows SegmentRows(const ControlRows& rows, double a, double b);

// The Bézier pieces, one for each span that is not empty, in order. [A5.6]
std::vector<ControlRows> DecomposeRows(const ControlRows& rows);

}  // namespace batten::internal
