// SPDX-License-Identifier: MIT
#include "fitting/least_squares/net_kernel.h"

#include "geometry/evaluation/evaluation_lanes.h"
#include "geometry/numeric/run_time_dispatch.h"

namespace batten::internal {
namespace {

using lanes::kAny;
using lanes::Load;
using lanes::Same;
using lanes::V4;

constexpr int kMostValues = (kMaxDegree + 4) / 4 * 4;

BATTEN_INLINE double Sum(V4 x) { return (x[0] + x[2]) + (x[1] + x[3]); }

// Σ_r outer[r] Σ_s inner[s] c(r, s); the rows of c are read in groups of four.
template <int P, int Q>
BATTEN_INLINE double TensorSum(
    int p, int q, const double* outer, const double* inner, const double* c, std::ptrdiff_t row) {
  const int rows = P == kAny ? p : P, groups = Q == kAny ? q / 4 + 1 : Q / 4 + 1;
  V4 total = Same(0);
  for (int g = 0; g < groups; ++g) {
    V4 sum = Same(0);
#pragma GCC unroll 4
    for (int r = 0; r <= rows; ++r) sum += outer[r] * Load(c + r * row + 4 * g);
    total += sum * Load(inner + 4 * g);
  }
  return Sum(total);
}

template <int P, int Q>
BATTEN_INLINE void SurfaceLoop(const AxisTable& outer,
                               const AxisTable& inner,
                               const NetPlanes& net,
                               const PointRows& points,
                               std::ptrdiff_t begin,
                               std::ptrdiff_t end,
                               double* values) {
  for (std::ptrdiff_t k = begin; k < end; ++k) {
    const lanes::Place u = lanes::Locate(outer, points.outer[k * points.stride]),
                       v = lanes::Locate(inner, points.inner[k * points.stride]);
    double No[kMostValues], Ni[kMostValues];
    lanes::BasisValues<P, 0>(outer, u, No);
    lanes::BasisValues<Q, 0>(inner, v, Ni);
    const double* c = net.planes + outer.first_point[u.span] * net.row + inner.first_point[v.span];
    for (int d = 0; d < points.dimension; ++d) {
      values[k * points.dimension + d] =
          TensorSum<P, Q>(outer.degree, inner.degree, No, Ni, c + d * net.plane, net.row);
    }
  }
}

template <int P>
BATTEN_INLINE void CurveLoop(const AxisTable& outer,
                             const NetPlanes& net,
                             const PointRows& points,
                             std::ptrdiff_t begin,
                             std::ptrdiff_t end,
                             double* values) {
  for (std::ptrdiff_t k = begin; k < end; ++k) {
    const lanes::Place u = lanes::Locate(outer, points.outer[k * points.stride]);
    double N[kMostValues];
    lanes::BasisValues<P, 0>(outer, u, N);
    const double* c = net.planes + outer.first_point[u.span];
    for (int d = 0; d < points.dimension; ++d) {
      V4 sum = Same(0);
      for (int g = 0; g <= outer.degree; g += 4) sum += Load(N + g) * Load(c + d * net.plane + g);
      values[k * points.dimension + d] = Sum(sum);
    }
  }
}

}  // namespace

BATTEN_CLONES void EvaluateNet(const AxisTable& outer,
                               const AxisTable* inner,
                               const NetPlanes& net,
                               const PointRows& points,
                               std::ptrdiff_t begin,
                               std::ptrdiff_t end,
                               double* values) {
  if (inner == nullptr && outer.degree == 3) {
    CurveLoop<3>(outer, net, points, begin, end, values);
  } else if (inner == nullptr) {
    CurveLoop<kAny>(outer, net, points, begin, end, values);
  } else if (outer.degree == 3 && inner->degree == 3) {
    SurfaceLoop<3, 3>(outer, *inner, net, points, begin, end, values);
  } else {
    SurfaceLoop<kAny, kAny>(outer, *inner, net, points, begin, end, values);
  }
}

}  // namespace batten::internal
