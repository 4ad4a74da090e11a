// SPDX-License-Identifier: MIT
// Kernel that finds foot points of many points on a polynomial curve, eight at a time.
#pragma once

#include <cstddef>

namespace batten::internal {

inline constexpr int kMaxFootDegree = 7;  // powers of a span's parameter lose no digits up to it

// A polynomial curve span by span. Plain pointers, for a kernel of run-time dispatch.
struct CurvePieceTable {
  int dimension, degree, pieces;
  bool periodic;
  const double* breaks;  // pieces + 1, increasing
  // Coefficients of the powers of x, dimension × (degree + 1) a piece, where x runs from −1 to 1
  // over the piece.
  const double* powers;
};

// The foot points found, one entry a point.
struct CurveFootPointsOut {
  double* parameters;  // of the foot points
  double* squares;     // squared distances
  int* pieces;         // −1: not found here
};

// Newton steps for |C(u) − q|² from a start near a local minimum, up to the minimum to rounding. It
// gives up (piece −1) where the steps do not converge directly: where the distance is about the
// radius of curvature, at sharp corners, and far away. Points are dimension × count, starts in the
// domain. Results do not depend on how points are grouped.
void LocalCurveFootPoints(const CurvePieceTable& table,
                          const double* points,
                          const double* starts,
                          std::ptrdiff_t count,
                          const CurveFootPointsOut& out);

}  // namespace batten::internal
