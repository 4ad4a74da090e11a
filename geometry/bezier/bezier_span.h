// SPDX-License-Identifier: MIT
// One polynomial piece of a spline in Bézier form.
#pragma once

#include <Eigen/Core>

#include "batten/geometry/spline_basis.h"

namespace batten::internal {

// The (p+1) × (p+1) matrix that turns the p+1 control points acting on a non-empty span (rows, in
// order) into the Bézier points of that piece: row j is the blossom with p−j arguments at the
// span's lower and j at its upper knot. Entries of a row sum to one; inside the domain of a clamped
// or unclamped basis they are not negative, so Bézier points lie in the hull of the control points.
// [Ramshaw 1989; Piegl & Tiller 1997, §5.3 reaches the same by knot insertion]
Eigen::MatrixXd BezierSpanMatrix(const SplineBasis& basis, int span);

}  // namespace batten::internal
