// SPDX-License-Identifier: MIT
// Extension of open curves at their ends, where the noise exceeds the point spacing.
#pragma once

#include "fitting/curve/parameter_correction.h"
#include "fitting/curve/span_layout.h"

namespace batten::internal {

// Returns the fit's span layout with its domain extended at both ends. Points beyond a clamped end
// all have their foot point at it and hold it back; each end moves out by the farthest of them
// along the tangent, less what noise does to the farthest of so many (0.7 σ √(2 ln count)), plus a
// mean spacing.
SpanLayout WithLooseEnds(const SpanLayout& layout,
                         const CorrectedFit& fit,
                         double noise,
                         double spacing);

}  // namespace batten::internal
