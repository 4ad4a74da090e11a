// SPDX-License-Identifier: MIT
// Moments of scattered points, summed knot cell by knot cell.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "batten/geometry/thread_pool.h"
#include "fitting/least_squares/moment_kernels.h"

namespace batten::internal {

// The moments of every knot cell, as moment_kernels.h defines them. Points are taken a chunk at a
// time, sorted into their cells within it, and added in their own order, so that the sums do not
// depend on the number of threads. Parameters must lie in the axes' domains. O(m (2p + 1)(2q + 1));
// memory of a chunk besides the moments.
class CellMoments {
 public:
  // Of no points; `dimension` values a point, so many spans of positive length; a curve has one
  // inner span and inner degree 0.
  CellMoments(const MomentSizes& sizes, int outer_spans, int inner_spans);

  // inner: null for a curve, whose points have no inner parameters either.
  CellMoments(const AxisTable& outer,
              const AxisTable* inner,
              const PointRows& points,
              ThreadPool& pool);

  // Adds points over the axes of the spans.
  void Add(const AxisTable& outer,
           const AxisTable* inner,
           const PointRows& points,
           ThreadPool& pool);

  const MomentSizes& sizes() const { return sizes_; }
  int outer_spans() const { return outer_spans_; }
  int inner_spans() const { return inner_spans_; }

  // The moments of a cell, given by its spans among those of positive length, and whether it holds
  // points of a weight other than zero.
  const double* at(int outer_span, int inner_span) const {
    return moments_.data() + Index(outer_span, inner_span);
  }
  double* at(int outer_span, int inner_span) {
    return moments_.data() + Index(outer_span, inner_span);
  }
  bool filled(int outer_span, int inner_span) const;

  // All moments as numbers that are added up to merge.
  std::span<double> numbers() { return moments_; }

 private:
  std::size_t Index(int outer_span, int inner_span) const {
    return (static_cast<std::size_t>(outer_span) * static_cast<std::size_t>(inner_spans_) +
            static_cast<std::size_t>(inner_span)) *
           static_cast<std::size_t>(sizes_.all());
  }

  MomentSizes sizes_;
  int outer_spans_, inner_spans_;
  std::vector<double> moments_;
};

}  // namespace batten::internal
