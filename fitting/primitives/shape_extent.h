// SPDX-License-Identifier: MIT
// The places along a line or circle that count for the extent that points cover.
#pragma once

#include <cmath>
#include <vector>

namespace batten::internal {

// The places without isolated ones: a place is isolated where each window of five neighbours around
// it is more than six times as wide as the median window. Some outliers happen to lie near a
// shape's continuation. Fewer than 16 places are all kept. `period` is infinite along a line.
std::vector<double> Supported(const std::vector<double>& places, double period = HUGE_VAL);

}  // namespace batten::internal
