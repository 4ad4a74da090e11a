// SPDX-License-Identifier: MIT
// The loops that evaluate a curve or surface at many parameters from its tables (kernel_tables.h).
//
// They are compiled for several instruction sets and choose at run time; no Eigen type crosses this
// header. evaluation_lanes.h has the same evaluations as inline functions for other kernel files.
#pragma once

#include <cstddef>

#include "geometry/evaluation/kernel_tables.h"

namespace batten::internal {

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

}  // namespace batten::internal
