// SPDX-License-Identifier: MIT
// A knot vector as distinct knots with multiplicities, so that all multiplicities can be changed
// together.
#pragma once

#include <vector>

#include "batten/geometry/spline_basis.h"

namespace batten::internal {

// The distinct knots of a basis in increasing order. Those of a periodic basis go on, whole periods
// away, for more than kMaxDegree knots beyond each end of the domain.
struct KnotGroups {
  std::vector<double> values;
  std::vector<int> counts;  // how often each value is repeated
  int lower, upper;         // the places of the ends of the domain in the list
  // The domain begins at u_p and ends at u_n; copies of these two values may lie inside: after u_p,
  // before u_n. Otherwise zero.
  int after_lower, before_upper;
  bool periodic;
};

KnotGroups GroupKnots(const SplineBasis& basis);

// The basis of the degree over these knots: the part of the list that has degree + 1 knots up to
// the lower and from the upper end of the domain on. BasisOfGroups(GroupKnots(b), p) is b itself,
// except that knots of a periodic basis that should be equal become equal.
SplineBasis BasisOfGroups(const KnotGroups& groups, int degree);

// Every multiplicity greater by one: the knots of an elevated spline.
KnotGroups RaisedMultiplicities(KnotGroups groups);

// Every multiplicity less by `by`, but no knot vanishes: the knots of a spline reduced from
// `degree`. Where knots are then missing up to an end of an unclamped domain, that end and those
// beyond keep more copies, in about the old proportion: knots that elevation left out cannot be
// known, and other proportions would leave the outer control points almost without influence.
KnotGroups LoweredMultiplicities(KnotGroups groups, int degree, int by);

}  // namespace batten::internal
