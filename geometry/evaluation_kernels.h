// SPDX-License-Identifier: MIT
// The tables a curve or surface is evaluated from, as plain memory, and the loops that read them.
//
// The loops are compiled for several instruction sets and choose at run time; everything else of
// batten is compiled for the baseline. Therefore no Eigen type crosses this header.
// evaluation_lanes.h has the same evaluations as inline functions for other kernel files.
//
// Homogeneous coordinates are four doubles (w·X, w·Y, w·Z, w), where X = P − centre: `centre` is
// the middle of the box of the control points, so that far from the origin no digits are lost. The
// weights of a table are divided by a power of two near the largest. Where it is not rational, the
// fourth coordinate of a sum is to be ignored.
#pragma once

#include <cstddef>

namespace batten {

class SplineBasis;

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

// All parameters are taken as SplineBasis::Clamp takes them: outside the domain clamped or wrapped;
// NaN, and ±∞ in a periodic direction, throw std::invalid_argument. Right-continuous at knots.

// For `count` parameters (u, v), one after the other: points (x, y, z) …
void EvaluatePoints(const SurfaceTable& table, const double* uv, std::size_t count, double* out);

// … and jets: point, S_u, S_v, S_uu, S_uv, S_vv, 18 doubles each.
void EvaluateJets(const SurfaceTable& table, const double* uv, std::size_t count, double* out);

// Points (3 doubles) and unit normals (3 doubles) at all pairs of us and vs, v fastest. A normal
// that S_u × S_v does not decide well is written as 0, 0, 0; the result is the number of those.
// `normals` may be null.
std::size_t EvaluateGrid(const SurfaceTable& table,
                         const double* us,
                         std::size_t u_count,
                         const double* vs,
                         std::size_t v_count,
                         double* points,
                         double* normals);

// For every parameter the derivatives 0 … order ≤ 3, `dimension` doubles each.
void EvaluateCurve(
    const CurveTable& table, const double* u, std::size_t count, int order, double* out);

}  // namespace batten
