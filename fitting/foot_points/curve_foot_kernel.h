// SPDX-License-Identifier: MIT
// Foot points of many points on a polynomial curve, eight at a time.
#pragma once

#include <cstddef>

namespace batten::internal {

inline constexpr int kMaxFootDegree = 7;  // powers of a span's parameter still lose nothing

// A polynomial curve span by span. Plain pointers, for a kernel of run-time dispatch.
struct CurvePieceTable {
  int dimension, degree, pieces;
  bool periodic;
  const double* breaks;  // pieces + 1, increasing
  // Of each piece dimension × (degree + 1): coefficients of the powers of x, which runs from −1 to
  // 1 over the piece.
  const double* powers;
};

// What was found for each of the points.
struct CurveFootPointsOut {
  double* parameters;  // of the foot points
  double* squares;     // squared distances
  int* pieces;         // −1: not found here
};

// Newton steps for |C(u) − q|² from a start near a local minimum, up to the minimum to rounding.
// Gives up where these do not lead straight there: where the distance is about the radius of
// curvature, at sharp corners, and far away. Points are dimension × count, starts in the domain.
// Answers do not depend on which points are asked for at once.
void LocalCurveFootPoints(const CurvePieceTable& table,
                          const double* points,
                          const double* starts,
                          std::ptrdiff_t count,
                          const CurveFootPointsOut& out);

}  // namespace batten::internal
