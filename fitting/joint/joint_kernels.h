// SPDX-License-Identifier: MIT
// The inner loop of the joint stage's sums, compiled for several instruction sets. Plain pointers
// only.
#pragma once

#include <cstddef>

namespace batten::internal {

// What one point of a knot cell adds to the sums of its cell.
inline constexpr int kMetricLanes = 8;  // a symmetric 3 × 3 matrix as xx, xy, xz, yy, yz, zz, then
                                        // a number, then 0
inline constexpr int kPullLanes = 4;    // a vector as x, y, z, then 0

// Numbers of pairs r ≤ r' of the degree's functions; pair (r, r') is the PairIndex-th.
constexpr int PairCount(int degree) { return (degree + 1) * (degree + 2) / 2; }
constexpr int PairIndex(int degree, int r, int later) {
  return r * (degree + 1) - r * (r - 1) / 2 + later - r;
}

// Adds over `count` points, with the p + 1 functions Nu and the q + 1 functions Nv of each and its
// metric M and pull g,
//   pairs[(j·PairCount(p) + i)·kMetricLanes + e] += Nu_r Nu_r' Nv_s Nv_s' M_e,
//     i the pair (r, r'), j the pair (s, s'), and
//   pulls[(r·(q + 1) + s)·kPullLanes + d] += Nu_r Nv_s g_d.
// Points are taken in order, in blocks that depend on `count` alone.
void AddCellProducts(int p,
                     int q,
                     const double* Nu,
                     const double* Nv,
                     const double* metrics,
                     const double* pulls_of_points,
                     std::ptrdiff_t count,
                     double* pairs,
                     double* pulls);

}  // namespace batten::internal
