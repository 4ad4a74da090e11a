// SPDX-License-Identifier: MIT
// Free-knot least squares: optimises the places of a given number of interior knots.
#pragma once

#include <cstdint>
#include <string>

#include "batten/fitting/fitting_problem.h"
#include "batten/fitting/progress.h"
#include "batten/fitting/solve_linear.h"
#include "batten/geometry/thread_pool.h"

namespace batten {

struct FreeKnotOptions {
  bool u = true, v = true;   // directions whose interior knots move; a curve has u only
  int max_iterations = 200;  // ≥ 0, of one descent; 0: the best knots found by insertion alone
  int starts = 24;           // ≥ 0, random ones; large problems take fewer
  double coalesce = 1e-6;    // in [0, 0.1], share of the domain: closer knots become one
  double stop_squares = 0;  // ≥ 0; stop when Σ w |S − z|² falls to this, the noise for example
  double seconds = 0;  // ≥ 0; stop after this time, 0: never. Results then depend on the machine
  std::uint64_t seed = 1;       // of the random starts
  Progress progress = nullptr;  // stage "knots"; asked to stop, the best so far is returned
};

// Throws std::invalid_argument naming the field that breaks its rule.
void Check(const FreeKnotOptions& options);

struct FreeKnotResult {
  FittingProblem problem;                        // over the knots found
  LinearSolution solution;                       // of that problem
  double squares_before = 0, squares_after = 0;  // Σ w |S − z|², squares_after ≤ squares_before
  int iterations = 0;                            // of all descents
  int starts = 0;                                // places that descents began from
  bool cancelled = false;                        // by progress
  std::string note;  // why nothing was done or it ended early; else empty
};

// Moves the interior knots of the problem, in the directions that options name, so that the least
// Σ w |S − z|² + λ·energy over all coefficients is small; parameters and the number of knots stay.
// Coefficients are eliminated (variable projection), knots move through the logarithms of their
// gaps, and each descent is Ceres' Levenberg–Marquardt. The sum has many minima, hence several
// starts: the given knots; no knots, with one inserted at a time where a trial of all spans is
// best; and random knots. In the best results narrow gaps are then closed, and each knot in turn is
// removed and reinserted where it lowers the sum most. Knots that come together are returned
// exactly equal, at most as often as the degree. `problem.smoothing()` keeps its meaning: λ follows
// the knots by the ratio of traces.
//
// The result is the same on any number of threads. Never worse than the given knots; where nothing
// better is found they come back, and `note` says why nothing was tried: no interior knot that may
// move, or too few data for the coefficients.
// Throws std::invalid_argument if a basis with moving knots is periodic or an option breaks its
// rule; and what SolveLinear throws.
// One evaluation costs O(m (p+1)²(q+1)²), for a curve O(m p³); a search some thousands of them when
// m is hundreds, some hundreds when it is many thousands, where insertion works on part of the
// data. [Golub & Pereyra 1973; Kaufman 1975; Jupp 1978]
FreeKnotResult OptimizeKnots(const FittingProblem& problem,
                             const FreeKnotOptions& options,
                             ThreadPool& pool);

}  // namespace batten
