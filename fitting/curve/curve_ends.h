// SPDX-License-Identifier: MIT
// Where an open curve ends, when its points are noisier than they are close.
#pragma once

#include "fitting/curve/parameter_correction.h"
#include "fitting/curve/span_layout.h"

namespace batten::internal {

// The fit's layout with a longer domain. Points beyond a clamped end all have their foot at it and
// hold it back; each end moves out by the farthest of them along the tangent, less what noise does
// to the farthest of so many (0.7 σ √(2 ln count)), plus a mean spacing.
SpanLayout WithLooseEnds(const SpanLayout& layout,
                         const CorrectedFit& fit,
                         double noise,
                         double spacing);

}  // namespace batten::internal
