// SPDX-License-Identifier: MIT
// The breaks of a spline.
#pragma once

#include <vector>

#include "batten/geometry/spline_basis.h"

namespace batten::internal {

// The ends of a basis' spans, rising, and the places that cut every span into equal parts.
inline std::vector<double> BreaksIn(const SplineBasis& basis, int parts = 1) {
  std::vector<double> breaks;
  for (const int span : basis.Spans()) {
    const double a = basis.knots()[span], b = basis.knots()[span + 1];
    for (int k = 0; k < parts; ++k) breaks.push_back(a + (b - a) * k / parts);
  }
  breaks.push_back(basis.upper());
  return breaks;
}

}  // namespace batten::internal
