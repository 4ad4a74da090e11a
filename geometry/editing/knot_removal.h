// SPDX-License-Identifier: MIT
// One knot less: the kernel of knot removal.
#pragma once

#include <optional>

#include "geometry/editing/control_rows.h"

namespace batten::internal {

struct OneKnotLess {
  ControlRows rows;
  double move;  // bound of how far a point moves
};

// The rows with the knot u removed once (over a periodic basis u and its copies), or none if
// weights would not be positive. u must be a knot u_{p+1} … u_{n-1} or, over a periodic basis,
// a seam of multiplicity two or more.
std::optional<OneKnotLess> WithoutKnot(const ControlRows& rows, double u);

// Bound of the distance at equal parameters of two shapes given as BezierRows with the same knots;
// `across` is the degree in the other direction of a surface, zero for a curve. With points P_i,
// P'_i and weights w_i, w'_i, and the point C somewhere in the hull of the piece,
//   |C' − C| ≤ max_i |P'_i − P_i| + |1 − w_i/w'_i|·|P_i − C|,
// which compares two quotients with the same functions above and below; it is exact for what is
// equal, quick, and without weights seldom more than four times the truth. [compare Piegl & Tiller
// 1997, eq. 5.30, which depends on the place of the origin]
double BezierDeviation(const ControlRows& from, const ControlRows& to, int across);

}  // namespace batten::internal
