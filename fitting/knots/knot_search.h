// SPDX-License-Identifier: MIT
// Global search of free knots: insertion, random starts and exchange. Used by the free-knot search
// only.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "fitting/knots/knot_descent.h"

namespace batten::internal {

// Best first, equal ones in the order in which they came; without those that failed.
std::vector<Descent> SortedDescents(std::vector<Descent> descents);

// The knots of the first `count` of sorted ones whose costs differ by more than a thousandth.
std::vector<MovingKnots> DifferentKnots(const std::vector<Descent>& sorted, int count);

// A search over one set of data. Everything it returns is the same on any number of threads.
class KnotSearch {
 public:
  // `parallel_starts`: descents run side by side, each on one thread; else one after another, each
  // on the whole pool. `stop` is asked often and from any thread.
  KnotSearch(const VariableProjection& projection,
             const DescentOptions& descent,
             bool parallel_starts,
             ThreadPool& pool);

  // Descends from every start; one result a start.
  std::vector<Descent> DescendAll(const std::vector<MovingKnots>& starts,
                                  const DescentOptions& options);

  // Inserts knots, from no free ones to as many as `wanted` has, one at a time (a sixteenth of them
  // at a time when they are many): the worst spans, all of them while they are few, are tried at
  // the middle and at the centroid of the squared residuals, descents start from the best `tried`,
  // and the best `kept` of them go on.
  std::vector<Descent> Insert(const MovingKnots& wanted, int kept, int tried);

  // Draws `count` sets of as many simple knots as `wanted` has, uniformly random. Fewer where the
  // data do not determine the coefficients even after several draws.
  std::vector<MovingKnots> RandomStarts(const MovingKnots& wanted, int count, std::uint64_t seed);

  // Merges the nearest neighbours and moves the least needed knots elsewhere, as long as that
  // lowers Φ after descending and until about `most_iterations` of descents.
  Descent Improve(Descent best, int most_iterations);

  // Closes gaps that are narrower than `share` of the domain where that raises Φ by no more than a
  // ten-thousandth after descending, and until `most_iterations` of descents.
  Descent CloseGaps(Descent best, double share, int most_iterations);

  int iterations() const { return iterations_; }
  int starts() const { return starts_; }

 private:
  const VariableProjection& projection_;
  DescentOptions options_;
  bool parallel_starts_;
  ThreadPool& pool_;
  int iterations_ = 0, starts_ = 0;
};

}  // namespace batten::internal
