// SPDX-License-Identifier: MIT
#include "geometry/evaluation/evaluation_kernels.h"

#include "geometry/evaluation/evaluation_lanes.h"

namespace batten::internal {
namespace lanes {
namespace {

template <int P, int Q, bool Patches, bool Rational>
BATTEN_INLINE void PointLoop(const SurfaceTable& table,
                             const double* uv,
                             std::size_t count,
                             double* out) {
  const V4 centre = Load(table.centre);
  for (std::size_t k = 0; k < count; ++k) {
    V4 h =
        PointAt<P, Q, Patches>(table, Locate(table.u, uv[2 * k]), Locate(table.v, uv[2 * k + 1]));
    if constexpr (Rational) h *= 1 / h[3];
    h += centre;
    // The fourth lane is overwritten by the next point.
    if (k + 1 < count) {
      Store(h, out + 3 * k);
    } else {
      Store3(h, out + 3 * k);
    }
  }
}

template <int P, int Q, bool Patches, bool Rational>
BATTEN_INLINE void JetLoop(const SurfaceTable& table,
                           const double* uv,
                           std::size_t count,
                           double* out) {
  const V4 centre = Load(table.centre);
  for (std::size_t k = 0; k < count; ++k, out += 18) {
    HomogeneousJet jet =
        JetAt<P, Q, Patches>(table, Locate(table.u, uv[2 * k]), Locate(table.v, uv[2 * k + 1]));
    if constexpr (Rational) Divide(jet);
    Store(jet.h + centre, out);
    Store(jet.hu, out + 3);
    Store(jet.hv, out + 6);
    Store(jet.huu, out + 9);
    Store(jet.huv, out + 12);
    Store3(jet.hvv, out + 15);
  }
}

// One loop for all that the table decides: the usual degrees have code of their own.
template <int P, int Q>
BATTEN_INLINE void ChoosePointLoop(const SurfaceTable& table,
                                   const double* uv,
                                   std::size_t count,
                                   double* out) {
  if (table.patches != nullptr) {
    if (table.rational) return PointLoop<P, Q, true, true>(table, uv, count, out);
    return PointLoop<P, Q, true, false>(table, uv, count, out);
  }
  if (table.rational) return PointLoop<P, Q, false, true>(table, uv, count, out);
  return PointLoop<P, Q, false, false>(table, uv, count, out);
}

template <int P, int Q>
BATTEN_INLINE void ChooseJetLoop(const SurfaceTable& table,
                                 const double* uv,
                                 std::size_t count,
                                 double* out) {
  if (table.patches != nullptr) {
    if (table.rational) return JetLoop<P, Q, true, true>(table, uv, count, out);
    return JetLoop<P, Q, true, false>(table, uv, count, out);
  }
  if (table.rational) return JetLoop<P, Q, false, true>(table, uv, count, out);
  return JetLoop<P, Q, false, false>(table, uv, count, out);
}

template <int P, int Order, int Dim>
BATTEN_INLINE void CurveLoop(const CurveTable& table,
                             const double* u,
                             std::size_t count,
                             double* out) {
  const V4 centre = Load(table.centre);
  for (std::size_t k = 0; k < count; ++k) {
    V4 h[Order + 1];
    CurveDerivatives<P, Order>(table, Locate(table.axis, u[k]), h);
    if (table.rational) Divide<Order>(h);
    h[0] += centre;
    for (int d = 0; d <= Order; ++d, out += Dim) {
      if constexpr (Dim == 3) {
        Store3(h[d], out);
      } else {
        Store2(h[d], out);
      }
    }
  }
}

template <int Dim>
BATTEN_INLINE void ChooseCurveLoop(
    const CurveTable& table, const double* u, std::size_t count, int order, double* out) {
  const bool cubic = table.axis.degree == 3;
  if (order == 0 && cubic) return CurveLoop<3, 0, Dim>(table, u, count, out);
  if (order == 0) return CurveLoop<kAny, 0, Dim>(table, u, count, out);
  if (order == 1 && cubic) return CurveLoop<3, 1, Dim>(table, u, count, out);
  if (order == 1) return CurveLoop<kAny, 1, Dim>(table, u, count, out);
  if (order == 2 && cubic) return CurveLoop<3, 2, Dim>(table, u, count, out);
  if (order == 2) return CurveLoop<kAny, 2, Dim>(table, u, count, out);
  if (cubic) return CurveLoop<3, 3, Dim>(table, u, count, out);
  return CurveLoop<kAny, 3, Dim>(table, u, count, out);
}

}  // namespace
}  // namespace lanes

BATTEN_CLONES void EvaluatePoints(const SurfaceTable& table,
                                  const double* uv,
                                  std::size_t count,
                                  double* out) {
  if (table.u.degree == 3 && table.v.degree == 3) {
    lanes::ChoosePointLoop<3, 3>(table, uv, count, out);
  } else {
    lanes::ChoosePointLoop<lanes::kAny, lanes::kAny>(table, uv, count, out);
  }
}

BATTEN_CLONES void EvaluateJets(const SurfaceTable& table,
                                const double* uv,
                                std::size_t count,
                                double* out) {
  if (table.u.degree == 3 && table.v.degree == 3) {
    lanes::ChooseJetLoop<3, 3>(table, uv, count, out);
  } else {
    lanes::ChooseJetLoop<lanes::kAny, lanes::kAny>(table, uv, count, out);
  }
}

BATTEN_CLONES void EvaluateCurve(
    const CurveTable& table, const double* u, std::size_t count, int order, double* out) {
  if (table.dimension == 3) {
    lanes::ChooseCurveLoop<3>(table, u, count, order, out);
  } else {
    lanes::ChooseCurveLoop<2>(table, u, count, order, out);
  }
}

}  // namespace batten::internal
