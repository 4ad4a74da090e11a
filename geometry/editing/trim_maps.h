// SPDX-License-Identifier: MIT
// Trim loops under maps of the parameter domain. Internal to geometry.
#pragma once

#include <vector>

#include "batten/geometry/direction.h"
#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/spline_basis.h"

namespace batten::internal {

using TrimLoops = std::vector<NurbsCurve<2>>;

// u ↦ lower + upper − u in one direction of the domain, `basis` being the surface's; loops run the
// other way, so that they stay turned.
TrimLoops ReversedTrims(const TrimLoops& loops, Direction direction, const SplineBasis& basis);

// u and v exchanged; loops run the other way.
TrimLoops SwappedTrims(const TrimLoops& loops);

// [lower, upper] of one direction onto [a, b], linearly.
TrimLoops ScaledTrims(
    const TrimLoops& loops, Direction direction, const SplineBasis& basis, double a, double b);

// The same by τ ↦ ρτ / (1 − τ + ρτ), τ and its image running from 0 to 1 across the two intervals,
// ρ > 0. A loop x = X/W, y = Y/W of degree p becomes x' = ρXW / (W·D), y = Y·D / (W·D) with D = W +
// (ρ−1)X: exactly a rational loop of degree 2p. Where weights would not be positive its pieces are
// halved. Knots keep the continuity that they had, to rounding. Throws std::invalid_argument where
// 2p is above kMaxDegree, and for a loop so far outside the domain that D vanishes on it.
TrimLoops MobiusTrims(const TrimLoops& loops,
                      Direction direction,
                      const SplineBasis& basis,
                      double a,
                      double b,
                      double ratio);

}  // namespace batten::internal
