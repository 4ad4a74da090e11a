// SPDX-License-Identifier: MIT
// Evaluation from tables (kernel_tables.h) as inline functions on four lanes, for kernel files
// that are compiled for several instruction sets (run_time_dispatch.h). Internal.
//
// Degrees are template arguments where speed matters; kAny reads them from the table.
#pragma once

#include <cstddef>

#include "batten/geometry/spline_basis.h"
#include "geometry/evaluation/kernel_tables.h"
#include "geometry/numeric/run_time_dispatch.h"

namespace batten::internal::lanes {

inline constexpr int kAny = 0;

// Four doubles in registers, and the same in memory wherever doubles may stand.
typedef double V4 __attribute__((vector_size(32)));
typedef double V4InMemory __attribute__((vector_size(32), aligned(8), may_alias));
typedef double V2InMemory __attribute__((vector_size(16), aligned(8), may_alias));

BATTEN_INLINE V4 Load(const double* from) { return *reinterpret_cast<const V4InMemory*>(from); }
BATTEN_INLINE void Store(V4 value, double* to) { *reinterpret_cast<V4InMemory*>(to) = value; }
BATTEN_INLINE void Store2(V4 value, double* to) {
  *reinterpret_cast<V2InMemory*>(to) = __builtin_shufflevector(value, value, 0, 1);
}
BATTEN_INLINE void Store3(V4 value, double* to) {
  *reinterpret_cast<V2InMemory*>(to) = __builtin_shufflevector(value, value, 0, 1);
  to[2] = value[2];
}
BATTEN_INLINE V4 Same(double x) { return V4{x, x, x, x}; }

// A span and the place on it: t from its start and o = 1 − t from its end, each of full precision.
struct Place {
  int span;
  double t, o;
};

// What Locate seldom needs, compiled once for the baseline: the parameter of the domain that stands
// for one outside it, and the last span that starts at or before u, which is beyond `low`.
double ClampToDomain(const AxisTable& axis, double u);
int SearchSpan(const AxisTable& axis, int low, double u);

// Right-continuous; parameters outside the domain as SplineBasis::Clamp takes them.
BATTEN_INLINE Place Locate(const AxisTable& axis, double u) {
  if (!(u >= axis.lower && u <= axis.upper)) [[unlikely]] {
    u = ClampToDomain(axis, u);
  }
  const unsigned cell =
      static_cast<unsigned>(static_cast<int>((u - axis.lower) * axis.cells_per_unit));
  const unsigned last = static_cast<unsigned>(axis.cell_count) - 1;
  int span = axis.cell_spans[cell < last ? cell : last];
  span += u >= axis.spans[span + 1].start;
  if (u >= axis.spans[span + 1].start) [[unlikely]] {
    span = SearchSpan(axis, span, u);
  }
  const TableSpan& found = axis.spans[span];
  return {span, (u - found.start) * found.scale, (found.end - u) * found.scale};
}

// t^j o^(d−j), j = 0 … d.
BATTEN_INLINE void Powers(int d, double t, double o, double* products) {
  double power = 1;
  for (int j = 0; j <= d; ++j) {
    products[j] = power;
    power *= t;
  }
  power = 1;
  for (int j = d; j >= 0; --j) {
    products[j] *= power;
    power *= o;
  }
}

// The functions that do not vanish on the span and their derivatives: values[k·stride + r] with
// stride = row_stride, rows padded by zeros. Works for k ≤ Order ≤ axis.order.
template <int P, int Order>
BATTEN_INLINE void BasisValues(const AxisTable& axis, Place at, double* values) {
  const int p = P == kAny ? axis.degree : P;
  const int stride = P == kAny ? axis.row_stride : (P + 4) / 4 * 4;
  const double* row = axis.basis + static_cast<std::size_t>(at.span) * axis.span_stride;
#pragma GCC unroll 4
  for (int k = 0; k <= Order; ++k) {
    double products[P == kAny ? kMaxDegree + 1 : P + 1];
    if (k <= p) Powers(p - k, at.t, at.o, products);
    for (int g = 0; g < stride; g += 4) {
      V4 sum = Same(0);
      for (int j = 0; j <= p - k; ++j) sum += products[j] * Load(row + j * stride + g);
      Store(sum, values + k * stride + g);
    }
    if (k <= p) row += (p - k + 1) * stride;
  }
}

// The homogeneous surface and its partial derivatives in u and v up to order two.
struct HomogeneousJet {
  V4 h, hu, hv, huu, huv, hvv;
};

// From the patch polynomial, by Horner's rule for a polynomial and half its second derivative.
template <int P, int Q>
BATTEN_INLINE V4 PatchPoint(const SurfaceTable& table, Place u, Place v) {
  const int p = P == kAny ? table.u.degree : P, q = Q == kAny ? table.v.degree : Q;
  const double* c = table.patches + (static_cast<std::size_t>(u.span) * table.v.span_count +
                                     static_cast<std::size_t>(v.span)) *
                                        table.patch_stride;
  const double a = u.t - u.o, b = v.t - v.o;
  V4 h = Same(0);
#pragma GCC unroll 4
  for (int r = p; r >= 0; --r) {
    V4 row = Load(c + 4 * (q * (p + 1) + r));
#pragma GCC unroll 4
    for (int s = q - 1; s >= 0; --s) row = row * b + Load(c + 4 * (s * (p + 1) + r));
    h = r == p ? row : h * a + row;
  }
  return h;
}

template <int P, int Q>
BATTEN_INLINE HomogeneousJet PatchJet(const SurfaceTable& table, Place u, Place v) {
  const int p = P == kAny ? table.u.degree : P, q = Q == kAny ? table.v.degree : Q;
  const double* c = table.patches + (static_cast<std::size_t>(u.span) * table.v.span_count +
                                     static_cast<std::size_t>(v.span)) *
                                        table.patch_stride;
  const double a = u.t - u.o, b = v.t - v.o;
  HomogeneousJet jet{};
#pragma GCC unroll 4
  for (int r = p; r >= 0; --r) {
    V4 h = Load(c + 4 * (q * (p + 1) + r)), hv = Same(0), hvv = Same(0);
#pragma GCC unroll 4
    for (int s = q - 1; s >= 0; --s) {
      if (s < q - 2) {
        hvv = hvv * b + hv;
      } else if (s == q - 2) {
        hvv = hv;
      }
      hv = s == q - 1 ? h : hv * b + h;
      h = h * b + Load(c + 4 * (s * (p + 1) + r));
    }
    if (r == p) {
      jet.h = h, jet.hv = hv, jet.hvv = hvv;
      continue;
    }
    if (r < p - 2) {
      jet.huu = jet.huu * a + jet.hu;
    } else if (r == p - 2) {
      jet.huu = jet.hu;
    }
    if (r == p - 1) {
      jet.hu = jet.h;
      jet.huv = jet.hv;
    } else {
      jet.hu = jet.hu * a + jet.h;
      jet.huv = jet.huv * a + jet.hv;
    }
    jet.h = jet.h * a + h;
    jet.hv = jet.hv * a + hv;
    jet.hvv = jet.hvv * a + hvv;
  }
  const double ku = 2 * table.u.spans[u.span].scale, kv = 2 * table.v.spans[v.span].scale;
  jet.hu *= ku;
  jet.hv *= kv;
  jet.huu *= 2 * ku * ku;
  jet.huv *= ku * kv;
  jet.hvv *= 2 * kv * kv;
  return jet;
}

// From the control net: the sum over v for every row, then over u.
template <int P, int Q>
BATTEN_INLINE V4 NetPoint(const SurfaceTable& table, Place u, Place v) {
  const int p = P == kAny ? table.u.degree : P, q = Q == kAny ? table.v.degree : Q;
  double Nu[P == kAny ? kMaxDegree + 4 : (P + 4) / 4 * 4];
  double Nv[Q == kAny ? kMaxDegree + 4 : (Q + 4) / 4 * 4];
  BasisValues<P, 0>(table.u, u, Nu);
  BasisValues<Q, 0>(table.v, v, Nv);
  const std::size_t first = static_cast<std::size_t>(table.u.first_point[u.span]) *
                                static_cast<std::size_t>(table.v_points) +
                            static_cast<std::size_t>(table.v.first_point[v.span]);
  V4 h = Same(0);
#pragma GCC unroll 4
  for (int r = 0; r <= p; ++r) {
    const double* net = table.net + 4 * (first + static_cast<std::size_t>(r) *
                                                     static_cast<std::size_t>(table.v_points));
    V4 row = Same(0);
#pragma GCC unroll 4
    for (int s = 0; s <= q; ++s) row += Nv[s] * Load(net + 4 * s);
    h += Nu[r] * row;
  }
  return h;
}

template <int P, int Q>
BATTEN_INLINE HomogeneousJet NetJet(const SurfaceTable& table, Place u, Place v) {
  constexpr int kU = P == kAny ? kMaxDegree + 4 : (P + 4) / 4 * 4;
  constexpr int kV = Q == kAny ? kMaxDegree + 4 : (Q + 4) / 4 * 4;
  const int p = P == kAny ? table.u.degree : P, q = Q == kAny ? table.v.degree : Q;
  const int nu = P == kAny ? table.u.row_stride : kU, nv = Q == kAny ? table.v.row_stride : kV;
  double Nu[3 * kU], Nv[3 * kV];
  BasisValues<P, 2>(table.u, u, Nu);
  BasisValues<Q, 2>(table.v, v, Nv);
  const std::size_t first = static_cast<std::size_t>(table.u.first_point[u.span]) *
                                static_cast<std::size_t>(table.v_points) +
                            static_cast<std::size_t>(table.v.first_point[v.span]);
  HomogeneousJet jet{};
#pragma GCC unroll 4
  for (int r = 0; r <= p; ++r) {
    const double* net = table.net + 4 * (first + static_cast<std::size_t>(r) *
                                                     static_cast<std::size_t>(table.v_points));
    V4 h = Same(0), hv = Same(0), hvv = Same(0);
#pragma GCC unroll 4
    for (int s = 0; s <= q; ++s) {
      const V4 point = Load(net + 4 * s);
      h += Nv[s] * point;
      hv += Nv[nv + s] * point;
      hvv += Nv[2 * nv + s] * point;
    }
    jet.h += Nu[r] * h;
    jet.hv += Nu[r] * hv;
    jet.hvv += Nu[r] * hvv;
    jet.hu += Nu[nu + r] * h;
    jet.huv += Nu[nu + r] * hv;
    jet.huu += Nu[2 * nu + r] * h;
  }
  return jet;
}

template <int P, int Q, bool Patches>
BATTEN_INLINE HomogeneousJet JetAt(const SurfaceTable& table, Place u, Place v) {
  if constexpr (Patches) {
    return PatchJet<P, Q>(table, u, v);
  } else {
    return NetJet<P, Q>(table, u, v);
  }
}

template <int P, int Q, bool Patches>
BATTEN_INLINE V4 PointAt(const SurfaceTable& table, Place u, Place v) {
  if constexpr (Patches) {
    return PatchPoint<P, Q>(table, u, v);
  } else {
    return NetPoint<P, Q>(table, u, v);
  }
}

// From homogeneous to Euclidean, relative to the centre; the fourth lane is of no use then.
// [Piegl & Tiller 1997, eq. 4.20]
BATTEN_INLINE void Divide(HomogeneousJet& jet) {
  const double inverse = 1 / jet.h[3];
  const double wu = jet.hu[3], wv = jet.hv[3];
  jet.h *= inverse;
  jet.hu = (jet.hu - wu * jet.h) * inverse;
  jet.hv = (jet.hv - wv * jet.h) * inverse;
  jet.huu = (jet.huu - 2 * wu * jet.hu - jet.huu[3] * jet.h) * inverse;
  jet.huv = (jet.huv - wu * jet.hv - wv * jet.hu - jet.huv[3] * jet.h) * inverse;
  jet.hvv = (jet.hvv - 2 * wv * jet.hv - jet.hvv[3] * jet.h) * inverse;
}

// The homogeneous curve and its derivatives 0 … Order.
template <int P, int Order>
BATTEN_INLINE void CurveDerivatives(const CurveTable& table, Place at, V4* h) {
  const int p = P == kAny ? table.axis.degree : P;
  const double* c = table.pieces + static_cast<std::size_t>(at.span) * table.piece_stride;
#pragma GCC unroll 4
  for (int k = 0; k <= Order; ++k) {
    double products[P == kAny ? kMaxDegree + 1 : P + 1];
    h[k] = Same(0);
    if (k > p) continue;
    Powers(p - k, at.t, at.o, products);
#pragma GCC unroll 4
    for (int j = 0; j <= p - k; ++j) h[k] += products[j] * Load(c + 4 * j);
    c += 4 * (p - k + 1);
  }
}

// From homogeneous to Euclidean derivatives, relative to the centre. [Piegl & Tiller 1997, eq. 4.8]
template <int Order>
BATTEN_INLINE void Divide(V4* h) {
  const double inverse = 1 / h[0][3];
  h[0] *= inverse;
  if constexpr (Order >= 1) {
    const double w1 = h[1][3];
    h[1] = (h[1] - w1 * h[0]) * inverse;
    if constexpr (Order >= 2) {
      const double w2 = h[2][3];
      h[2] = (h[2] - 2 * w1 * h[1] - w2 * h[0]) * inverse;
      if constexpr (Order >= 3) {
        h[3] = (h[3] - 3 * w1 * h[2] - 3 * w2 * h[1] - h[3][3] * h[0]) * inverse;
      }
    }
  }
}

}  // namespace batten::internal::lanes
