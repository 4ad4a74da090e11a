// SPDX-License-Identifier: MIT
// Moments of scattered points, summed knot cell by knot cell.
#pragma once

#include <vector>

#include "fitting/least_squares/moment_kernels.h"
#include "batten/geometry/thread_pool.h"

namespace batten::internal {

// The moments of every knot cell, as moment_kernels.h defines them. Points are taken a chunk at a
// time, sorted into their cells within it, and added in their own order, so that the sums do not
// depend on the number of threads. Parameters must lie in the axes' domains. O(m (2p + 1)(2q + 1));
// memory of a chunk besides the moments.
class CellMoments {
 public:
  // inner: null for a curve, whose points have no inner parameters either.
  CellMoments(const AxisTable& outer,
              const AxisTable* inner,
              const PointRows& points,
              ThreadPool& pool);

  const MomentSizes& sizes() const { return sizes_; }

  // Whether a cell, given by its spans among those of positive length, holds points of a weight
  // other than zero; and its moments.
  bool filled(int outer_span, int inner_span) const {
    return filled_[Index(outer_span, inner_span)];
  }
  const double* at(int outer_span, int inner_span) const {
    return moments_.data() + Index(outer_span, inner_span) * static_cast<size_t>(sizes_.all());
  }

 private:
  size_t Index(int outer_span, int inner_span) const {
    return static_cast<size_t>(outer_span) * static_cast<size_t>(inner_spans_) +
           static_cast<size_t>(inner_span);
  }

  MomentSizes sizes_;
  int inner_spans_;
  std::vector<double> moments_;
  std::vector<char> filled_;
};

}  // namespace batten::internal
