// SPDX-License-Identifier: MIT
// Points and unit normals on a grid of parameters. Along one row u is fixed: there the surface and
// its derivatives are polynomials in v, span by span, whose Bernstein forms are found once; then
// many v are taken at a time, one in every lane.
#include <cmath>

#include "geometry/evaluation/evaluation_kernels.h"
#include "geometry/evaluation/evaluation_lanes.h"

namespace batten::internal {
namespace lanes {
namespace {

constexpr int kChunk = 256;  // parameters v that are located at once
constexpr int kWidth = 4;

// Consecutive parameters of one span.
struct Run {
  int span, begin, end;
};

// The parameters of a chunk on their spans.
struct LocatedChunk {
  double t[kChunk + kWidth], o[kChunk + kWidth];
  Run runs[kChunk];
  int run_count;
};

BATTEN_INLINE void LocateChunk(const AxisTable& axis,
                               const double* vs,
                               int count,
                               LocatedChunk& chunk) {
  chunk.run_count = 0;
  for (int k = 0; k < count; ++k) {
    const Place at = Locate(axis, vs[k]);
    chunk.t[k] = at.t;
    chunk.o[k] = at.o;
    if (k == 0 || chunk.runs[chunk.run_count - 1].span != at.span) {
      chunk.runs[chunk.run_count++] = {at.span, k, k};
    }
    chunk.runs[chunk.run_count - 1].end = k + 1;
  }
  for (int k = count; k < count + kWidth; ++k) chunk.t[k] = chunk.o[k] = 0.5;
}

// On one row and span: H, H_u (degree q) and H_v (degree q − 1) as Bernstein forms without
// binomials, and how much rounding their sums may carry, relative to 2^-53 and the extent.
template <int Q>
struct RowPiece {
  V4 h[Q == kAny ? kMaxDegree + 1 : Q + 1], hu[Q == kAny ? kMaxDegree + 1 : Q + 1];
  V4 hv[Q == kAny ? kMaxDegree : Q];
  double noise_u, noise_v;
};

// Nu has the values and first derivatives of the functions in u.
template <int P, int Q>
BATTEN_INLINE void MakeRowPiece(
    const SurfaceTable& table, int u_span, const double* Nu, int v_span, RowPiece<Q>& piece) {
  const int p = P == kAny ? table.u.degree : P, q = Q == kAny ? table.v.degree : Q;
  const std::size_t v_points = static_cast<std::size_t>(table.v_points);
  const double* net =
      table.net + 4 * (static_cast<std::size_t>(table.u.first_point[u_span]) * v_points +
                       static_cast<std::size_t>(table.v.first_point[v_span]));
  const double* dNu = Nu + table.u.row_stride;
  const double* e0 = table.v.basis + static_cast<std::size_t>(v_span) * table.v.span_stride;
  const double* e1 = e0 + (q + 1) * table.v.row_stride;
  for (int k = 0; k <= q; ++k) piece.h[k] = piece.hu[k] = Same(0);
  for (int k = 0; k < q; ++k) piece.hv[k] = Same(0);
  piece.noise_u = piece.noise_v = 0;
#pragma GCC unroll 4
  for (int s = 0; s <= q; ++s) {
    V4 h = Same(0), hu = Same(0);
    double sum = 0;
#pragma GCC unroll 4
    for (int r = 0; r <= p; ++r) {
      const V4 point = Load(net + 4 * (static_cast<std::size_t>(r) * v_points + s));
      h += Nu[r] * point;
      hu += dNu[r] * point;
      sum += std::abs(dNu[r]) * point[3];
    }
    piece.noise_u = sum > piece.noise_u ? sum : piece.noise_u;
    for (int k = 0; k <= q; ++k) {
      const double e = e0[k * table.v.row_stride + s];
      piece.h[k] += e * h;
      piece.hu[k] += e * hu;
    }
    for (int k = 0; k < q; ++k) {
      const double e = e1[k * table.v.row_stride + s];
      piece.hv[k] += e * h;
      piece.noise_v += std::abs(e) * h[3];
    }
  }
}

// The sum of c[k]·products[k] in one coordinate.
template <typename C>
BATTEN_INLINE V4 Sum(const C& c, int lane, const V4* products, int degree) {
  V4 sum = c[0][lane] * products[0];
#pragma GCC unroll 4
  for (int k = 1; k <= degree; ++k) sum += c[k][lane] * products[k];
  return sum;
}

BATTEN_INLINE void LanePowers(int d, V4 t, V4 o, V4* products) {
  products[0] = Same(1);
#pragma GCC unroll 4
  for (int j = 1; j <= d; ++j) products[j] = products[j - 1] * t;
  V4 power = o;
#pragma GCC unroll 4
  for (int j = d - 1; j >= 0; --j) {
    products[j] *= power;
    power *= o;
  }
}

// Four points from coordinate lanes to memory, x y z after x y z.
BATTEN_INLINE void StoreInterleaved(V4 x, V4 y, V4 z, double* out) {
  const V4 a = __builtin_shufflevector(x, y, 0, 4, 1, 5),
           b = __builtin_shufflevector(x, y, 2, 6, 3, 7);
  const V4 c = __builtin_shufflevector(a, z, 3, 5, 3, 5);
  Store(__builtin_shufflevector(a, z, 0, 1, 4, 2), out);
  Store(__builtin_shufflevector(c, b, 0, 1, 4, 5), out + 4);
  Store(__builtin_shufflevector(z, b, 2, 6, 7, 3), out + 8);
}

BATTEN_INLINE void StoreFirst(V4 x, V4 y, V4 z, int count, double* out) {
  if (count >= kWidth) return StoreInterleaved(x, y, z, out);
  double whole[3 * kWidth];
  StoreInterleaved(x, y, z, whole);
  for (int k = 0; k < 3 * count; ++k) out[k] = whole[k];
}

struct Lanes3 {
  V4 x, y, z;
};

BATTEN_INLINE V4 Dot(const Lanes3& a, const Lanes3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

// Unit normals, zero where the tangents are so short or so parallel, against what rounding may have
// done to them, that the direction has fewer than some nine digits.
BATTEN_INLINE Lanes3 Normals(const Lanes3& du,
                             const Lanes3& dv,
                             double noise_u,
                             double noise_v,
                             int count,
                             std::size_t& undecided) {
  Lanes3 n = {du.y * dv.z - du.z * dv.y, du.z * dv.x - du.x * dv.z, du.x * dv.y - du.y * dv.x};
  constexpr double kLeast = 0x1p-40;  // (2^-20)²
  const V4 squared = Dot(n, n);
  const V4 bound =
      kLeast * (noise_u * noise_u * Dot(dv, dv) + noise_v * noise_v * Dot(du, du)) + 1e-280;
  const auto good = (squared > bound) & (squared < 1e280);
  V4 length;
  for (int k = 0; k < kWidth; ++k) length[k] = std::sqrt(squared[k]);
  V4 inverse = 1 / length;
  inverse = good ? inverse : Same(0);
  n.x = good ? n.x * inverse : Same(0);
  n.y = good ? n.y * inverse : Same(0);
  n.z = good ? n.z * inverse : Same(0);
  for (int k = 0; k < count && k < kWidth; ++k) undecided += good[k] == 0;
  return n;
}

template <int Q, bool Rational>
BATTEN_INLINE std::size_t EvaluateRun(const SurfaceTable& table,
                                      const RowPiece<Q>& piece,
                                      const double* t,
                                      const double* o,
                                      int count,
                                      double* points,
                                      double* normals) {
  const int q = Q == kAny ? table.v.degree : Q;
  std::size_t undecided = 0;
  for (int k = 0; k < count; k += kWidth, points += 3 * kWidth) {
    V4 B[Q == kAny ? kMaxDegree + 1 : Q + 1];
    LanePowers(q, Load(t + k), Load(o + k), B);
    Lanes3 h = {Sum(piece.h, 0, B, q), Sum(piece.h, 1, B, q), Sum(piece.h, 2, B, q)};
    V4 inverse = Same(1);
    if constexpr (Rational) {
      inverse = 1 / Sum(piece.h, 3, B, q);
      h = {h.x * inverse, h.y * inverse, h.z * inverse};
    }
    StoreFirst(
        h.x + table.centre[0], h.y + table.centre[1], h.z + table.centre[2], count - k, points);
    if (normals == nullptr) continue;
    Lanes3 du = {Sum(piece.hu, 0, B, q), Sum(piece.hu, 1, B, q), Sum(piece.hu, 2, B, q)};
    V4 wu = Same(0);
    if constexpr (Rational) wu = Sum(piece.hu, 3, B, q);
    LanePowers(q - 1, Load(t + k), Load(o + k), B);
    Lanes3 dv = {
        Sum(piece.hv, 0, B, q - 1), Sum(piece.hv, 1, B, q - 1), Sum(piece.hv, 2, B, q - 1)};
    if constexpr (Rational) {  // w times the tangents: the same direction
      const V4 wv = Sum(piece.hv, 3, B, q - 1);
      du = {du.x - wu * h.x, du.y - wu * h.y, du.z - wu * h.z};
      dv = {dv.x - wv * h.x, dv.y - wv * h.y, dv.z - wv * h.z};
    }
    const Lanes3 n = Normals(
        du, dv, table.extent * piece.noise_u, table.extent * piece.noise_v, count - k, undecided);
    StoreFirst(n.x, n.y, n.z, count - k, normals);
    normals += 3 * kWidth;
  }
  return undecided;
}

template <int P, int Q, bool Rational>
BATTEN_INLINE std::size_t GridLoop(const SurfaceTable& table,
                                   const double* us,
                                   std::size_t u_count,
                                   const double* vs,
                                   std::size_t v_count,
                                   double* points,
                                   double* normals) {
  std::size_t undecided = 0;
  LocatedChunk chunk;
  double Nu[2 * (P == kAny ? kMaxDegree + 4 : (P + 4) / 4 * 4)];
  RowPiece<Q> piece;
  for (std::size_t first = 0; first < v_count; first += kChunk) {
    const int count = static_cast<int>(v_count - first < kChunk ? v_count - first : kChunk);
    LocateChunk(table.v, vs + first, count, chunk);
    for (std::size_t i = 0; i < u_count; ++i) {
      const Place u = Locate(table.u, us[i]);
      BasisValues<P, 1>(table.u, u, Nu);
      for (int k = 0; k < chunk.run_count; ++k) {
        const Run run = chunk.runs[k];
        const std::size_t at = 3 * (i * v_count + first + static_cast<std::size_t>(run.begin));
        MakeRowPiece<P, Q>(table, u.span, Nu, run.span, piece);
        undecided += EvaluateRun<Q, Rational>(table,
                                              piece,
                                              chunk.t + run.begin,
                                              chunk.o + run.begin,
                                              run.end - run.begin,
                                              points + at,
                                              normals == nullptr ? nullptr : normals + at);
      }
    }
  }
  return undecided;
}

}  // namespace
}  // namespace lanes

BATTEN_CLONES std::size_t EvaluateGrid(const SurfaceTable& table,
                                       const double* us,
                                       std::size_t u_count,
                                       const double* vs,
                                       std::size_t v_count,
                                       double* points,
                                       double* normals) {
  using lanes::kAny;
  const bool cubic = table.u.degree == 3 && table.v.degree == 3;
  if (cubic && table.rational) {
    return lanes::GridLoop<3, 3, true>(table, us, u_count, vs, v_count, points, normals);
  }
  if (cubic) return lanes::GridLoop<3, 3, false>(table, us, u_count, vs, v_count, points, normals);
  if (table.rational) {
    return lanes::GridLoop<kAny, kAny, true>(table, us, u_count, vs, v_count, points, normals);
  }
  return lanes::GridLoop<kAny, kAny, false>(table, us, u_count, vs, v_count, points, normals);
}

}  // namespace batten::internal
