// SPDX-License-Identifier: MIT
// The tables a curve or surface is evaluated from, as plain memory.
//
// They are read by loops that are compiled for several instruction sets and choose at run time;
// everything else of batten is compiled for the baseline. Therefore no Eigen type crosses this
// header.
//
// Homogeneous coordinates are four doubles (w·X, w·Y, w·Z, w), where X = P − centre: `centre` is
// the middle of the box of the control points, so that far from the origin no digits are lost. The
// weights of a table are divided by a power of two near the largest. Where it is not rational, the
// fourth coordinate of a sum is to be ignored.
#pragma once

#include <cstddef>

namespace batten {
class SplineBasis;
}  // namespace batten

namespace batten::internal {

// A span [start, end) of one direction, with scale = 1 / its length.
struct TableSpan {
  double start, end, scale;
};

// The basis functions of one direction, span by span (only spans of positive length).
//  Span search: parameter u falls into cell (u − lower)·cells_per_unit of a uniform grid with about
//  four cells a span; cell_spans[cell] is the span of the cell's lower end or one before, and the
//  last entry, spans[span_count].start, is +infinity.
//  On a span t = (u − start)·scale runs over [0, 1] and o = (end − u)·scale, which keeps its digits
//  where t is nearly 1, is 1 − t; with B_j = t^j o^(p−k−j) (no binomials) the k-th derivatives (in
//  u, k ≤ order) of the functions r = 0 … p that do not vanish there are
//    N_r^(k)(u) = Σ_{j=0..p-k} E_k[j][r] B_j,
//  E_k[j][r] = basis[span·span_stride + (k·(p+1) − k(k−1)/2 + j)·row_stride + r];
//  rows are padded by zeros to row_stride, a multiple of 4. E_0 ≥ 0: values keep all their digits.
//  first_point[span] is the control point of r = 0.
struct AxisTable {
  double lower, upper;
  double cells_per_unit;
  int degree, order;
  int span_count, cell_count;
  int row_stride, span_stride;
  const int* cell_spans;
  const TableSpan* spans;
  const int* first_point;
  const double* basis;
  const SplineBasis* outside;  // says what stands for a parameter outside the domain
};

// A surface. Control point (i, j) is net[4·(i·v_points + j)].
//  `patches`, where not null, holds for the pair (i, j) of spans the polynomial of the surface in
//  a, b ∈ [−1, 1], a = t − o in u and b in v:
//    H(a, b) = Σ_{r=0..p} Σ_{s=0..q} c_rs a^r b^s,
//    c_rs = patches[(i·v.span_count + j)·patch_stride + 4·(s·(p+1) + r)]  (r runs fastest).
//  It is null where monomials would lose digits or take too much memory (SurfaceEvaluator).
struct SurfaceTable {
  AxisTable u, v;
  bool rational;
  int v_points;
  std::size_t patch_stride;
  const double* net;
  const double* patches;
  double centre[4];  // the last is 0
  double extent;     // the largest |X|, |Y|, |Z| of the control points
};

// A curve: on a span the k-th derivative (in u, k ≤ 3) of the homogeneous curve is
//  Σ_{j=0..p-k} h_kj t^j o^(p−k−j), h_kj four doubles at
//  pieces[span·piece_stride + 4·(k·(p+1) − k(k−1)/2 + j)]; a plane curve has Z = 0.
struct CurveTable {
  AxisTable axis;
  bool rational;
  int dimension;
  std::size_t piece_stride;
  const double* pieces;
  double centre[4];
};

}  // namespace batten::internal
