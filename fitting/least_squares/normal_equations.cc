// SPDX-License-Identifier: MIT
#include "fitting/least_squares/normal_equations.h"

#include <algorithm>
#include <cstdlib>
#include <optional>
#include <utility>

#include "fitting/linear/coefficient_order.h"
#include "geometry/evaluation/evaluation_table.h"

namespace batten::internal {
namespace {

using OptionalAxis = std::optional<AxisStorage>;

OptionalAxis AxisOf(const SplineBasis* basis) {
  return basis ? OptionalAxis(std::in_place, *basis, 0) : std::nullopt;
}

const AxisTable* Table(const OptionalAxis& axis) { return axis ? &axis->table() : nullptr; }

CellMoments MomentsOf(const SplineBasis& outer,
                      const SplineBasis* inner,
                      const PointRows& points,
                      ThreadPool& pool) {
  const AxisStorage outer_axis(outer, 0);
  const OptionalAxis inner_axis = AxisOf(inner);
  return CellMoments(outer_axis.table(), Table(inner_axis), points, pool);
}

// Converts moments of a span into sums over products of its basis functions, p being the degree.
class SpanForms {
 public:
  // Function r of a span is Σ_j E[j][r] t^j o^(p−j), so that N_r N_{r+a} = Σ_k C[k][r][a] t^k
  // o^(2p−k) with C[k][r][a] = Σ_j E[j][r] E[k−j][r+a].
  explicit SpanForms(const AxisTable* axis)
      : axis_(axis), p_(axis ? axis->degree : 0), pairs_(static_cast<size_t>(spans() * stride())) {
    for (int span = 0; span < spans(); ++span) {
      double* C = pairs_.data() + span * stride();
      for (int j = 0; j <= p_; ++j) {
        for (int j2 = 0; j2 <= p_; ++j2) {
          double* row = C + (j + j2) * width();
          for (int r = 0; r <= p_; ++r) {
            for (int a = 0; r + a <= p_; ++a)
              row[r * (p_ + 1) + a] += functions(span)[j * function_row() + r] *
                                       functions(span)[j2 * function_row() + r + a];
          }
        }
      }
    }
  }

  int degree() const { return p_; }
  int spans() const { return axis_ ? axis_->span_count : 1; }
  int first(int span) const { return axis_ ? axis_->first_point[span] : 0; }
  int width() const { return (p_ + 1) * (p_ + 1); }

  // C[k][r][a] at k·width + r(p+1) + a, zeros where r + a > p: side by side, the rows r lie as the
  // rows of a band do.
  const double* pairs(int span) const { return pairs_.data() + span * stride(); }

  // E[j][r] at j·function_row + r.
  const double* functions(int span) const {
    static constexpr double kOne = 1;
    return axis_ ? axis_->basis + std::ptrdiff_t{span} * axis_->span_stride : &kOne;
  }
  int function_row() const { return axis_ ? axis_->row_stride : 1; }

 private:
  std::ptrdiff_t stride() const { return std::ptrdiff_t{2 * p_ + 1} * width(); }

  const AxisTable* axis_;
  int p_;
  std::vector<double> pairs_;
};

// The sums of moments of an outer span over its cells, turned into products of inner functions:
// row k holds moment k of every pair of neighbouring inner functions, and behind them of every
// function and value.
class Strip {
 public:
  Strip(const CellMoments& moments, const SpanForms& inner, int inner_size, int outer_span)
      : pair_row_(std::ptrdiff_t{inner_size} * (inner.degree() + 1)), value_row_(inner_size) {
    const int p = moments.sizes().p, q = moments.sizes().q, d = moments.sizes().dimension;
    pairs_.assign(static_cast<size_t>((2 * p + 1) * pair_row_), 0.0);
    values_.assign(static_cast<size_t>(d * (p + 1) * value_row_), 0.0);
    for (int span = 0; span < inner.spans(); ++span) {
      if (!moments.filled(outer_span, span)) continue;
      const double* cell = moments.at(outer_span, span);
      const std::ptrdiff_t at = std::ptrdiff_t{inner.first(span)} * (q + 1);
      AddProduct(2 * p + 1,
                 2 * q + 1,
                 inner.width(),
                 cell,
                 2 * q + 1,
                 1,
                 inner.pairs(span),
                 inner.width(),
                 pairs_.data() + at,
                 pair_row_);
      AddProduct(d * (p + 1),
                 q + 1,
                 q + 1,
                 cell + moments.sizes().squares(),
                 q + 1,
                 1,
                 inner.functions(span),
                 inner.function_row(),
                 values_.data() + inner.first(span),
                 value_row_);
    }
  }

  std::ptrdiff_t pair_row() const { return pair_row_; }
  const double* pairs() const { return pairs_.data(); }
  const double* values(int row) const { return values_.data() + row * value_row_; }

 private:
  std::ptrdiff_t pair_row_, value_row_;
  std::vector<double> pairs_, values_;
};

// For every outer function the first and the last span that it lives on.
struct SpanRange {
  int first = 0, end = 0;
};
std::vector<SpanRange> SpansOfFunctions(const SpanForms& outer, int size) {
  std::vector<SpanRange> ranges(static_cast<size_t>(size));
  for (int span = 0; span < outer.spans(); ++span) {
    for (int r = 0; r <= outer.degree(); ++r) {
      SpanRange& range = ranges[static_cast<size_t>(outer.first(span) + r)];
      if (range.end == 0) range.first = span;
      range.end = span + 1;
    }
  }
  return ranges;
}

}  // namespace

CellOrder::CellOrder(const SplineBasis& outer_basis,
                     const SplineBasis* inner_basis,
                     const Eigen::VectorXd& outer,
                     const Eigen::VectorXd& inner) {
  const AxisStorage outer_axis(outer_basis, 0);
  const OptionalAxis inner_axis = AxisOf(inner_basis);
  const std::vector<int> outer_spans = outer_basis.Spans(),
                         inner_spans = inner_basis ? inner_basis->Spans() : std::vector<int>{0};
  const int columns = static_cast<int>(inner_spans.size());
  const int cell_count = static_cast<int>(outer_spans.size()) * columns;
  const Eigen::Index m = outer.size();
  std::vector<int> cell_of(static_cast<size_t>(m));
  std::vector<int> counts(static_cast<size_t>(cell_count) + 1, 0);
  FindCells(outer_axis.table(),
            Table(inner_axis),
            {m, outer.data(), inner.data(), 1, nullptr, 0, nullptr},
            0,
            m,
            cell_of.data(),
            counts.data());
  std::vector<Eigen::Index> next(static_cast<size_t>(cell_count));
  Eigen::Index begin = 0;
  for (int c = 0; c < cell_count; ++c) {
    const int count = counts[static_cast<size_t>(c)];
    next[static_cast<size_t>(c)] = begin;
    if (count > 0) {
      cells_.push_back({outer_spans[static_cast<size_t>(c / columns)],
                        inner_spans[static_cast<size_t>(c % columns)],
                        begin,
                        begin + count});
    }
    begin += count;
  }
  points_.resize(static_cast<size_t>(m));
  for (Eigen::Index k = 0; k < m; ++k)
    points_[static_cast<size_t>(next[static_cast<size_t>(cell_of[static_cast<size_t>(k)])]++)] = k;
}

NormalEquations::NormalEquations(const SplineBasis& outer_basis,
                                 const SplineBasis* inner_basis,
                                 const PointRows& points,
                                 ThreadPool& pool)
    : NormalEquations(
          outer_basis, inner_basis, MomentsOf(outer_basis, inner_basis, points, pool), pool) {}

NormalEquations::NormalEquations(const SplineBasis& outer_basis,
                                 const SplineBasis* inner_basis,
                                 const CellMoments& moments,
                                 ThreadPool& pool)
    : outer_rows_(CoefficientOrder(outer_basis).Rows(outer_basis)),
      inner_rows_(DistinctIndices(inner_basis)),
      band_(outer_basis.size(),
            static_cast<int>(inner_rows_.size()),
            outer_basis.degree(),
            inner_basis ? inner_basis->degree() : 0) {
  const AxisStorage outer_axis(outer_basis, 0);
  const OptionalAxis inner_axis = AxisOf(inner_basis);
  const SpanForms outer(&outer_axis.table()), inner(Table(inner_axis));
  const int p = outer.degree(), q = inner.degree(), dimension = moments.sizes().dimension;
  const int outer_size = outer_basis.size(), inner_size = static_cast<int>(inner_rows_.size());

  std::vector<std::optional<Strip>> strips(static_cast<size_t>(outer.spans()));
  pool.For(outer.spans(), 1, [&](std::ptrdiff_t first, std::ptrdiff_t last) {
    for (std::ptrdiff_t span = first; span < last; ++span)
      strips[static_cast<size_t>(span)].emplace(moments, inner, inner_size, static_cast<int>(span));
  });
  const std::ptrdiff_t pair_row = band_.row_size();
  std::vector<double> values(static_cast<size_t>(outer_size) * dimension * inner_size, 0.0);
  const std::vector<SpanRange> ranges = SpansOfFunctions(outer, outer_size);
  pool.For(outer_size, 1, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (std::ptrdiff_t i = begin; i < end; ++i) {
      const SpanRange range = ranges[static_cast<size_t>(i)];
      for (int span = range.first; span < range.end; ++span) {
        const Strip& strip = *strips[static_cast<size_t>(span)];
        const auto r = static_cast<int>(i) - outer.first(span);
        AddProduct(p + 1 - r,
                   2 * p + 1,
                   static_cast<int>(pair_row),
                   outer.pairs(span) + r * (p + 1),
                   1,
                   outer.width(),
                   strip.pairs(),
                   pair_row,
                   band_.row(static_cast<int>(i), 0),
                   pair_row);
        for (int d = 0; d < dimension; ++d) {
          AddProduct(1,
                     p + 1,
                     inner_size,
                     outer.functions(span) + r,
                     0,
                     outer.function_row(),
                     strip.values(d * (p + 1)),
                     inner_size,
                     values.data() + (i * dimension + d) * inner_size,
                     0);
        }
      }
    }
  });

  const int inner_distinct = inner_basis ? DistinctCount(*inner_basis) : 1;
  rhs_ =
      Eigen::MatrixXd::Zero(Eigen::Index{DistinctCount(outer_basis)} * inner_distinct, dimension);
  for (int i = 0; i < outer_size; ++i) {
    const Eigen::Index row = Eigen::Index{outer_rows_[static_cast<size_t>(i)]} * inner_distinct;
    const double* diagonal = band_.row(i, 0);
    for (int j = 0; j < inner_size; ++j) {
      trace_ += diagonal[j * (q + 1)];
      for (int d = 0; d < dimension; ++d)
        rhs_(row + inner_rows_[static_cast<size_t>(j)], d) +=
            values[static_cast<size_t>((i * dimension + d) * inner_size + j)];
    }
  }
  for (int o = 0; o < outer.spans(); ++o) {
    for (int i = 0; i < inner.spans(); ++i) squares_ += moments.at(o, i)[moments.sizes().all() - 1];
  }
}

void NormalEquations::AddTo(BlockBandedMatrix& matrix) const {
  band_.AddTo(matrix, outer_rows_, inner_rows_);
}

PointRows RowsOf(const Eigen::VectorXd& outer,
                 const Eigen::VectorXd& inner,
                 const Eigen::MatrixXd& values,
                 const Eigen::VectorXd& weights) {
  return {outer.size(),
          outer.data(),
          inner.size() > 0 ? inner.data() : nullptr,
          1,
          values.data(),
          static_cast<int>(values.rows()),
          weights.size() > 0 ? weights.data() : nullptr};
}

BlockBandedMatrix EmptyMatrix(const SplineBasis& outer_basis, const SplineBasis* inner_basis) {
  const CoefficientOrder order(outer_basis);
  return BlockBandedMatrix(
      order.count(), inner_basis ? DistinctCount(*inner_basis) : 1, order.bandwidth());
}

}  // namespace batten::internal
