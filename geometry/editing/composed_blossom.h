// SPDX-License-Identifier: MIT
// The kernel of composition: blossoms of a spline of a spline. Not installed.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace batten::internal {

// One piece of a spline: `degree`, its knots, and the non-empty span i, knots[i] < knots[i+1].
struct SplinePiece {
  int degree;
  const std::vector<double>* knots;
  int span;
};

// Different numbers, each with how often it stands.
struct Multiset {
  std::vector<double> values;
  std::vector<int> counts;
};

// The p+1 numbers that combine the coefficients acting on the piece `outer` (degree p) to the
// blossom of outer ∘ inner at the p·q arguments; `inner` has degree q and these coefficients on its
// piece. The mean, over all ways to deal the arguments into p groups of q, of the blossom of
// `outer` at the blossoms of `inner` at the groups. Arguments should come with those farthest from
// the piece first: then extrapolation stays smallest. The sum of the result is one to rounding.
// With d different arguments O(p²·N·G), N the sub-multisets of size 0, q, 2q, … and G the ways to
// draw a group from them; a composition of splines with p, q ≥ 2 has d ≤ 3, and for p = 1 or q = 1
// both numbers are one. [DeRose, Goldman, Hagen & Mann 1993, §3]
Eigen::VectorXd ComposedBlossom(const SplinePiece& outer,
                                const SplinePiece& inner,
                                const Eigen::VectorXd& inner_coefficients,
                                const Multiset& arguments);

}  // namespace batten::internal
