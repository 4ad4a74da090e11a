// SPDX-License-Identifier: MIT
// The normal matrix of a fit's points over the unknowns of its shape, and shared noise.
#pragma once

#include <Eigen/SparseCore>
#include <functional>

#include "fitting/uncertainty/displacement_rows.h"
#include "fitting/uncertainty/weighed_points.h"

namespace batten::internal {

// The row of a point: DisplacementRows::At its foot, for mirrored shapes with that of its image.
using RowOfPoint = std::function<SparseRow(Eigen::Index)>;

// Σ w J Jᵀ, both triangles. Gathered knot cell by knot cell. O(m k²), k the length of a row.
Eigen::SparseMatrix<double> NormalForm(const DisplacementRows& rows,
                                       const WeighedPoints& points,
                                       const RowOfPoint& row_of);

// The factor by which noise that neighbours share raises the variance of sums over parts of knot
// cells: mean squares of sums of pulls over what white noise of the given variance would leave of
// them, ΣS² / Σ σ² (Σ w − aᵀ(2 M⁻¹ − M⁻¹AM⁻¹)a), a = Σ w J; at the width where it is largest. One
// where it is not significant, or blocks have less than four points. `unfitted` is the form
// aᵀ(2 M⁻¹ − M⁻¹AM⁻¹)a.
double SharedNoise(const DisplacementRows& rows,
                   const WeighedPoints& points,
                   const RowOfPoint& row_of,
                   const std::function<double(const SparseRow&)>& unfitted,
                   double variance);

}  // namespace batten::internal
