// SPDX-License-Identifier: MIT
// The conditions of poles in the order of the solver.
#pragma once

#include <Eigen/Core>

#include "batten/fitting/block_banded_matrix.h"
#include "batten/fitting/poles.h"
#include "batten/geometry/spline_basis.h"

namespace batten {

// PoleConditions on the rows of the normal matrix: those of the outer basis in its
// CoefficientOrder, inside each the different inner coefficients.
Eigen::MatrixXd PoleConditionsOnRows(const SplineBasis& basis_u,
                                     const SplineBasis& basis_v,
                                     const Poles& poles,
                                     bool u_outside);

// From the free solution M⁻¹b, a column of `rows` each, that under C x = 0: by Lagrange's
// multipliers, x − M⁻¹Cᵀ (C M⁻¹ Cᵀ)⁻¹ C x, M given by its factor. O(conditions) solutions more.
void MeetConditions(const BlockBandedMatrix& factor,
                    const Eigen::MatrixXd& conditions,
                    Eigen::MatrixXd& rows);

}  // namespace batten
