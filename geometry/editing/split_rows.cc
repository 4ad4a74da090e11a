// SPDX-License-Identifier: MIT
#include "geometry/editing/split_rows.h"

#include "geometry/editing/knot_refinement.h"
#include "geometry/numeric/number_text.h"
#include "geometry/numeric/reject.h"

namespace batten::internal {

std::pair<ControlRows, ControlRows> SplitRows(const ControlRows& rows,
                                              const std::string& name,
                                              double u) {
  const SplineBasis& basis = rows.basis;
  const int p = basis.degree();
  if (!(u > basis.lower() && u < basis.upper())) {
    Reject("Split",
           name + " = " + NumberText(u) + " is not strictly inside the domain " +
               IntervalText(basis.lower(), basis.upper()));
  }
  // Both pieces come out of one refinement with u repeated p times.
  const std::vector<double> more(p - basis.Multiplicity(u), u);
  const ControlRows whole = Cut(rows, basis.lower(), basis.upper(), more);
  const std::vector<double>& U = whole.basis.knots();
  int first = 0;  // place of the first u
  while (U[first] < u) ++first;
  std::vector<double> low(U.begin(), U.begin() + first + p), high(U.begin() + first, U.end());
  low.push_back(u);
  high.insert(high.begin(), u);
  return {ColumnsOf(whole, 0, SplineBasis(p, std::move(low))),
          ColumnsOf(whole, first - 1, SplineBasis(p, std::move(high)))};
}

ControlRows SegmentRows(const ControlRows& rows, double a, double b) {
  const SplineBasis& basis = rows.basis;
  const bool inside = a >= basis.lower() && a < b && b <= basis.upper();
  if (inside) return Cut(rows, a, b);
  const double period = basis.upper() - basis.lower();
  if (basis.periodic() && a >= basis.lower() && a < basis.upper() && b > a && b <= a + period) {
    return Cut(UnrolledTwice(rows), a, b);
  }
  Reject("Segment",
         IntervalText(a, b) + " is not a piece of the domain " +
             IntervalText(basis.lower(), basis.upper()) +
             (basis.periodic() ? " or of one period from a place of it" : ""));
}

std::vector<ControlRows> DecomposeRows(const ControlRows& rows) {
  const int p = rows.basis.degree();
  const ControlRows whole = BezierRows(rows);
  std::vector<ControlRows> pieces;
  for (const int span : whole.basis.Spans()) {
    const std::vector<double>& U = whole.basis.knots();
    std::vector<double> knots(p + 1, U[span]);
    knots.insert(knots.end(), p + 1, U[span + 1]);
    pieces.push_back(ColumnsOf(whole, span - p, SplineBasis(p, std::move(knots))));
  }
  return pieces;
}

}  // namespace batten::internal
