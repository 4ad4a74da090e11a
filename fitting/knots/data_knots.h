// SPDX-License-Identifier: MIT
// Knots for interpolation around closed curves, and the Schoenberg–Whitney condition.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "batten/geometry/spline_basis.h"

namespace batten::internal {

// A periodic basis with as many different functions as there are conditions, and the parameters of
// the data in its domain, which is that of the data.
struct ClosedKnots {
  SplineBasis basis;
  Eigen::VectorXd parameters;
};

// Chooses knots for interpolation of m values around a closed curve: m + 1 parameters, of which the
// last is the first one's again, one period later; repeated where more than one condition is given.
// For odd degrees and single conditions the knots are the parameters, and interpolation has one
// solution however they are spaced. Otherwise every knot is the mean of `degree` parameters in a
// row, going round; the domain begins at a knot, so that parameters move on by a part of a step.
// Throws std::invalid_argument unless 1 ≤ degree ≤ kMaxDegree, m ≥ 1, the parameters are finite and
// do not decrease and are not all equal, and no knot would be there more than `degree` times.
// [Schoenberg 1973; Marsden 1974]
ClosedKnots KnotsAround(int degree, std::span<const double> parameters);

// Returns the first function that violates the Schoenberg–Whitney condition: parameters can be
// assigned to the functions in order, each its own inside its support; none where the condition
// holds. Then, and only then, interpolation at as many parameters as functions has one solution,
// and so have least squares at more of them. The parameters must not decrease; repeated they stand
// for a value and derivatives there, in least squares leave repetitions out. Not for periodic
// bases. O(n + m). [Schoenberg & Whitney 1953; de Boor 1978, XIII]
std::optional<int> FirstUnsupported(const SplineBasis& basis, std::span<const double> parameters);

}  // namespace batten::internal
