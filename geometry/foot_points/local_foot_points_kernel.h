// SPDX-License-Identifier: MIT
// The descent of many points to their local foot points, eight at a time, compiled for several
// instruction sets. Plain pointers only. Internal to local_foot_points.h.
#pragma once

#include <cstddef>

#include "geometry/evaluation/kernel_tables.h"

namespace batten::internal {

inline constexpr int kFootPointLanes = 8;

// What became of a descent: it stands at its foot; it goes on in another cell; or it is none of the
// plain cases and is left to LocalFootPoint.
inline constexpr double kFootSettled = 0, kFootLeaves = 1, kFootHard = 2;

// The descents of many points, one entry each.
struct FootPointLanes {
  const double *x, *y, *z;  // the points, less the table's centre
  double *u, *v;            // where they stand
  double *du, *dv;          // the steps they try from there
  double* squares;  // |S − q|² where they stand; infinite: the start has not been looked at
  double* side;     // (q − S)·(S_u × S_v) there
  double* tries;    // how often the step was halved
  double* state;    // out: kFoot…
};

// Entries [begin, end) whose trials lie in one cell between knots; whole groups of eight.
struct CorrectionRun {
  int span_u, span_v;
  std::size_t begin, end;
};

// Newton steps for |S − q|² in the box of the whole domain, never uphill, as LocalFootPoint takes
// them: shifted where the Hessian is not positive definite, held at sides that descent would leave.
// A last step too small to need another evaluation is taken by Taylor's formula. What happens to an
// entry does not depend on its neighbours. Needs table.patches.
void DescendInCells(const SurfaceTable& table,
                    const CorrectionRun* runs,
                    std::size_t run_count,
                    const FootPointLanes& lanes);

}  // namespace batten::internal
