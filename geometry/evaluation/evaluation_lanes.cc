// SPDX-License-Identifier: MIT
#include "geometry/evaluation/evaluation_lanes.h"

#include <algorithm>

namespace batten::internal::lanes {

double ClampToDomain(const AxisTable& axis, double u) { return axis.outside->Clamp(u); }

int SearchSpan(const AxisTable& axis, int low, double u) {
  const TableSpan* after =
      std::upper_bound(axis.spans + low + 1,
                       axis.spans + axis.span_count,
                       u,
                       [](double value, const TableSpan& span) { return value < span.start; });
  return static_cast<int>(after - axis.spans) - 1;
}

}  // namespace batten::internal::lanes
