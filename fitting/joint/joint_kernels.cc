// SPDX-License-Identifier: MIT
#include "fitting/joint/joint_kernels.h"

#include <algorithm>

#include "batten/geometry/spline_basis.h"
#include "geometry/numeric/run_time_dispatch.h"

namespace batten::internal {
namespace {

typedef double V8 __attribute__((vector_size(64)));
typedef double V8InMemory __attribute__((vector_size(64), aligned(8), may_alias));
typedef double V4 __attribute__((vector_size(32)));
typedef double V4InMemory __attribute__((vector_size(32), aligned(8), may_alias));

constexpr int kAny = -1;
constexpr int kTile = 5;  // of pairs whose sums are held in registers

constexpr int MostPairs(int degree) { return PairCount(degree == kAny ? kMaxDegree : degree); }

// All N_r N_r' with r ≤ r', row by row.
template <int P>
BATTEN_INLINE void Pairs(const double* N, int degree, double* pairs) {
  const int p = P == kAny ? degree : P;
  for (int r = 0, i = 0; r <= p; ++r) {
    for (int s = r; s <= p; ++s) pairs[i++] = N[r] * N[s];
  }
}

// sums[t] += Σ_k factor[k·stride] · terms[k·row + t], t < Count.
template <int Count>
BATTEN_INLINE void AddTile(
    const V8InMemory* terms, int row, const double* factor, int stride, int count, double* sums) {
  V8InMemory* to = reinterpret_cast<V8InMemory*>(sums);
  V8 sum[Count];
#pragma GCC unroll 8
  for (int t = 0; t < Count; ++t) sum[t] = to[t];
  for (int k = 0; k < count; ++k) {
    const double b = factor[k * stride];
#pragma GCC unroll 8
    for (int t = 0; t < Count; ++t) sum[t] += b * terms[k * row + t];
  }
#pragma GCC unroll 8
  for (int t = 0; t < Count; ++t) to[t] = sum[t];
}

template <int P, int Q>
BATTEN_INLINE void AddPulls(
    int p, int q, const double* Nu, const double* Nv, const double* g, double* sums) {
  const int last_u = P == kAny ? p : P, last_v = Q == kAny ? q : Q;
  const V4 pull = *reinterpret_cast<const V4InMemory*>(g);
  V4InMemory* to = reinterpret_cast<V4InMemory*>(sums);
  for (int r = 0; r <= last_u; ++r) {
    const V4 row = Nu[r] * pull;
    for (int s = 0; s <= last_v; ++s) to[r * (last_v + 1) + s] += Nv[s] * row;
  }
}

template <int P, int Q>
BATTEN_INLINE void AddAll(int any_p,
                          int any_q,
                          const double* Nu,
                          const double* Nv,
                          const double* metrics,
                          const double* g,
                          std::ptrdiff_t count,
                          double* pairs,
                          double* pulls) {
  constexpr int kBlock = P == kAny ? 1 : 16;
  const int p = P == kAny ? any_p : P, q = Q == kAny ? any_q : Q;
  const int outer = PairCount(p), inner = PairCount(q);
  double terms[kBlock * MostPairs(P) * kMetricLanes], of_v[kBlock * MostPairs(Q)];
  for (std::ptrdiff_t first = 0; first < count; first += kBlock) {
    const int points = static_cast<int>(std::min<std::ptrdiff_t>(kBlock, count - first));
    for (int k = 0; k < points; ++k) {
      double of_u[MostPairs(P)];
      Pairs<P>(Nu + (first + k) * (p + 1), p, of_u);
      Pairs<Q>(Nv + (first + k) * (q + 1), q, of_v + k * inner);
      const V8 metric = *reinterpret_cast<const V8InMemory*>(metrics + (first + k) * kMetricLanes);
      V8InMemory* to = reinterpret_cast<V8InMemory*>(terms) + k * outer;
      for (int i = 0; i < outer; ++i) to[i] = of_u[i] * metric;
      AddPulls<P, Q>(p,
                     q,
                     Nu + (first + k) * (p + 1),
                     Nv + (first + k) * (q + 1),
                     g + (first + k) * kPullLanes,
                     pulls);
    }
    const V8InMemory* from = reinterpret_cast<const V8InMemory*>(terms);
    for (int j = 0; j < inner; ++j) {
      double* sums = pairs + static_cast<std::ptrdiff_t>(j) * outer * kMetricLanes;
      int i = 0;
      for (; i + kTile <= outer; i += kTile)
        AddTile<kTile>(from + i, outer, of_v + j, inner, points, sums + i * kMetricLanes);
      for (; i < outer; ++i)
        AddTile<1>(from + i, outer, of_v + j, inner, points, sums + i * kMetricLanes);
    }
  }
}

}  // namespace

BATTEN_CLONES
void AddCellProducts(int p,
                     int q,
                     const double* Nu,
                     const double* Nv,
                     const double* metrics,
                     const double* pulls_of_points,
                     std::ptrdiff_t count,
                     double* pairs,
                     double* pulls) {
  if (p == 3 && q == 3) {
    AddAll<3, 3>(p, q, Nu, Nv, metrics, pulls_of_points, count, pairs, pulls);
  } else if (p == 2 && q == 2) {
    AddAll<2, 2>(p, q, Nu, Nv, metrics, pulls_of_points, count, pairs, pulls);
  } else if (p == 3 && q == 0) {
    AddAll<3, 0>(p, q, Nu, Nv, metrics, pulls_of_points, count, pairs, pulls);
  } else {
    AddAll<kAny, kAny>(p, q, Nu, Nv, metrics, pulls_of_points, count, pairs, pulls);
  }
}

}  // namespace batten::internal
