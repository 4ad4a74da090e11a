// SPDX-License-Identifier: MIT
// Linear solve of a surface whose coefficients stay with the data.
#pragma once

#include <cmath>

#include "batten/fitting/fitting_problem.h"
#include "batten/fitting/solve_linear.h"
#include "batten/geometry/thread_pool.h"

namespace batten::internal {

struct BoundedSolution {
  LinearSolution solution;
  int held = 0;         // coefficients at a bound
  bool in_box = false;  // it would have left the box of its data (HeldInBox)
};

// Minimises the problem's sum while every coefficient keeps the bounds of BoundsFromData: least
// squares alone leave the points where these do not determine a coefficient, under cliffs, in holes
// and at borders. An active-set method: coefficients outside their bounds are held at them, those
// whose gradient points inwards are released, in so many rounds at most (a set may cycle); what is
// outside then is moved to its bound. [Björck 1996, §5.2] Points in space are bounded along the
// normal of a smooth shape, and held as a whole. A solution within its bounds is returned bit for
// bit as SolveLinear returns it; one with poles has no bounds. Where the surface would leave the
// box of its data all the same, it is held in that (data_box.h). That is taken where the rms error
// grows by a fifth at most, or is at most `held_rms`: what is trimmed away need not be held at the
// points' cost. Where the values are followed to their `noise` (0: unknown), but no longer within
// the bounds, these are too narrow for the shape, and wider ones are taken. Bounds are slack by the
// data's spacing and noise. Values: heights or points in space. O(m (p+1)(q+1)), and a
// factorization for each round.
BoundedSolution SolveWithinBounds(const FittingProblem& problem,
                                  double spacing,
                                  ThreadPool& pool,
                                  double held_rms = HUGE_VAL,
                                  double noise = 0,
                                  int most_rounds = 3);

}  // namespace batten::internal
