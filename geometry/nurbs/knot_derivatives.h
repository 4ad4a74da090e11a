// SPDX-License-Identifier: MIT
// How B-spline functions change when their knots move.
#pragma once

#include <Eigen/Core>

#include "batten/geometry/spline_basis.h"

namespace batten::internal {

// The p+1 functions of `span` at u and their derivatives with respect to the 2p knots that they
// depend on there: row j, column r of the result is ∂N_{span−p+r}(u)/∂u_{span−p+1+j}, every knot of
// the vector taken as a variable of its own while u stays. Where several knots coincide and are to
// move together their rows add up; a periodic knot and its copies add up too. `values` receives the
// functions themselves (p+1). Each row sums to zero, since the functions sum to one wherever the
// knots are. Precondition: a span of positive length. Derivatives are those of the polynomial piece
// of `span`: of two values on a knot, the one of that side. O(p³). [forward differentiation of the
// recurrence of Piegl & Tiller 1997, A2.2; the same numbers as Piegl & Tiller 1998, "Computing the
// derivative of NURBS with respect to a knot"]
using KnotDerivativeMatrix = Eigen::
    Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor, 2 * kMaxDegree, kMaxDegree + 1>;
KnotDerivativeMatrix KnotDerivatives(const SplineBasis& basis, int span, double u, double* values);

}  // namespace batten::internal
