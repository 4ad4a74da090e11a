// SPDX-License-Identifier: MIT
#include "fitting/neighbours/nearest_sample.h"

#include <limits>

#include "geometry/numeric/run_time_dispatch.h"

namespace batten::internal {

BATTEN_CLONES
std::ptrdiff_t NearestSample(
    const double* x, const double* y, std::ptrdiff_t count, double at_x, double at_y) {
  constexpr std::ptrdiff_t kLanes = kSampleLanes;
  double least[kLanes], first[kLanes];  // of each lane, and where it is: a double holds that too
  for (std::ptrdiff_t l = 0; l < kLanes; ++l) {
    least[l] = std::numeric_limits<double>::infinity();
    first[l] = 0;
  }
  for (std::ptrdiff_t i = 0; i < count; i += kLanes) {
    const auto at = static_cast<double>(i);
    for (std::ptrdiff_t l = 0; l < kLanes; ++l) {
      const double dx = x[i + l] - at_x, dy = y[i + l] - at_y;
      const double square = dx * dx + dy * dy;
      const bool nearer = square < least[l];
      least[l] = nearer ? square : least[l];
      first[l] = nearer ? at : first[l];
    }
  }
  std::ptrdiff_t nearest = static_cast<std::ptrdiff_t>(first[0]);
  double square = least[0];
  for (std::ptrdiff_t l = 1; l < kLanes; ++l) {
    const std::ptrdiff_t own = static_cast<std::ptrdiff_t>(first[l]) + l;
    if (least[l] > square || (least[l] == square && own > nearest)) continue;
    square = least[l];
    nearest = own;
  }
  return nearest;
}

}  // namespace batten::internal
