// SPDX-License-Identifier: MIT
// What edges of a surface that are one point ask of its coefficients.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "batten/fitting/pole_kind.h"
#include "batten/geometry/spline_basis.h"

namespace batten {

// Conditions C c = 0 on the coefficients c that differ (u_i, v_j at i · n_v + j, counts as
// DistinctCount says), independent of each other; no rows without poles. With c_i0 the first row
// and c_i1 the second, seen from the edge, and γ, δ the splines over basis_u nearest to the cosine
// and the sine of the angle about the pole: all c_i0 = P, and c_i1 = Q + γ_i a + δ_i b for some
// vectors a, b and Q, of a smooth pole Q = P. Then all tangents S_v there lie in the plane of a and
// b, and turn in it with the angle: the normal is the same from all sides. The third row of a
// smooth pole carries no harmonics of the angle above the second, as that of v^k, k > 2, in a
// surface that is smooth about its pole. (Second row from degree 2 in v on, third from degree 3.)
Eigen::MatrixXd PoleConditions(const SplineBasis& basis_u,
                               const SplineBasis& basis_v,
                               const Poles& poles);

// How many they are.
int PoleConditionCount(const SplineBasis& basis_u, const SplineBasis& basis_v, const Poles& poles);

// What the conditions leave free of the rows they are on: c_ij = Σ_k form(i, k) t_(first + k), all
// such rows j together with orthonormal columns.
struct TiedRow {
  int j;
  Eigen::Index first;
  Eigen::MatrixXd form;
};
struct PoleFreedom {
  std::vector<TiedRow> rows;  // from the start inwards, then from the end inwards
  Eigen::Index unknowns = 0;  // t: eight at a smooth pole of degree 3
};
PoleFreedom FreeVariablesOf(const SplineBasis& basis_u,
                            const SplineBasis& basis_v,
                            const Poles& poles);

// The nearest coefficients, row by row, that meet the conditions exactly: d × (n_u · n_v), v
// fastest, repeated ones too. Rounding of what a solver found under the conditions is taken away,
// so that the edge is one point to the last bit.
Eigen::MatrixXd WithPolesClosed(Eigen::MatrixXd coefficients,
                                const SplineBasis& basis_u,
                                const SplineBasis& basis_v,
                                const Poles& poles);

}  // namespace batten
