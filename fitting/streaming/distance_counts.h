// SPDX-License-Identifier: MIT
// Signed distances that pass by, as numbers of each size.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "batten/fitting/fit_report.h"

namespace batten::internal {

// Counts distances by size, in steps of 512 to an octave, so that
// quantiles are right to 0.1 %; sums and extremes are exact. Counts of parts are added up by adding
// numbers(), and by the greatest.
class DistanceCounts {
 public:
  // `unit` > 0: distances below 1e-12 of it, or above 1e12, are not told apart.
  DistanceCounts(double unit, std::optional<double> tolerance);

  void Add(double distance);

  // All that is counted as numbers that are added up to merge; the greatest distance apart.
  std::span<double> numbers() { return numbers_; }
  double greatest() const { return greatest_; }
  void set_greatest(double greatest) { greatest_ = greatest; }

  ErrorSummary Summary() const;

 private:
  double Quantile(double share, bool with_sign) const;

  double unit_;
  std::optional<double> tolerance_;
  double greatest_ = 0;
  std::vector<double> numbers_;  // count, squares, sizes, out of tolerance; then counts by size
};

}  // namespace batten::internal
