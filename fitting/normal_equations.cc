// SPDX-License-Identifier: MIT
#include "batten/fitting/normal_equations.h"

#include <algorithm>
#include <cstdlib>

#include "batten/fitting/coefficient_order.h"

namespace batten {
namespace {

// All N_r N_s with r ≤ s, row by row.
inline void Pairs(const double* N, int p, double* pairs) {
  for (int r = 0, k = 0; r <= p; ++r) {
    for (int s = r; s <= p; ++s) pairs[k++] = N[r] * N[s];
  }
}

// gram += weight · a bᵀ, rows of length nb. The sizes of cubics are known to the compiler.
template <int Fixed>
inline void Rank1(double* gram, const double* a, int na, const double* b, int nb, double weight) {
  const int rows = Fixed > 0 ? Fixed : na, columns = Fixed > 0 ? Fixed : nb;
  for (int i = 0; i < rows; ++i) {
    const double c = weight * a[i];
    for (int j = 0; j < columns; ++j) gram[i * columns + j] += c * b[j];
  }
}

}  // namespace

CellOrder::CellOrder(const SplineBasis& outer_basis,
                     const SplineBasis* inner_basis,
                     const Eigen::VectorXd& outer,
                     const Eigen::VectorXd& inner) {
  const std::vector<int> outer_spans = outer_basis.Spans(),
                         inner_spans = inner_basis ? inner_basis->Spans() : std::vector<int>{0};
  std::vector<int> outer_rank(outer_basis.size(), 0),
      inner_rank(inner_basis ? inner_basis->size() : 1, 0);
  for (size_t k = 0; k < outer_spans.size(); ++k) outer_rank[outer_spans[k]] = static_cast<int>(k);
  for (size_t k = 0; k < inner_spans.size(); ++k) inner_rank[inner_spans[k]] = static_cast<int>(k);
  const int columns = static_cast<int>(inner_spans.size());
  cell_count_ = static_cast<int>(outer_spans.size()) * columns;
  const Eigen::Index m = outer.size();
  std::vector<int> cell_of(static_cast<size_t>(m));
  std::vector<Eigen::Index> start(static_cast<size_t>(cell_count_) + 1, 0);
  for (Eigen::Index k = 0; k < m; ++k) {
    cell_of[k] = outer_rank[outer_basis.Span(outer[k])] * columns +
                 (inner_basis ? inner_rank[inner_basis->Span(inner[k])] : 0);
    ++start[cell_of[k] + 1];
  }
  for (int c = 0; c < cell_count_; ++c) {
    if (start[c + 1] > 0) {
      cells_.push_back(
          {outer_spans[c / columns], inner_spans[c % columns], start[c], start[c] + start[c + 1]});
    }
    start[c + 1] += start[c];
  }
  points_.resize(static_cast<size_t>(m));
  for (Eigen::Index k = 0; k < m; ++k) points_[start[cell_of[k]]++] = k;
}

NormalEquations::NormalEquations(const SplineBasis& outer_basis,
                                 const SplineBasis* inner_basis,
                                 const Eigen::VectorXd& outer,
                                 const Eigen::VectorXd& inner,
                                 const Eigen::MatrixXd& values,
                                 const Eigen::VectorXd& weights,
                                 const CellOrder& order,
                                 ThreadPool& pool)
    : degree_outer_(outer_basis.degree()),
      degree_inner_(inner_basis ? inner_basis->degree() : 0),
      outer_rows_(CoefficientOrder(outer_basis).Rows(outer_basis)),
      inner_rows_(DistinctIndices(inner_basis)),
      cells_(order.cells()) {
  const int p = degree_outer_, q = degree_inner_;
  const int pairs_outer = (p + 1) * (p + 2) / 2, pairs_inner = (q + 1) * (q + 2) / 2;
  const int functions = (p + 1) * (q + 1);
  const auto dimension = static_cast<int>(values.rows());
  const size_t gram_size = static_cast<size_t>(pairs_outer) * pairs_inner;
  grams_.assign(cells_.size() * gram_size, 0.0);
  std::vector<double> cell_rhs(cells_.size() * functions * dimension, 0.0);
  std::vector<double> cell_squares(cells_.size(), 0.0);

  pool.For(static_cast<std::ptrdiff_t>(cells_.size()),
           8,
           [&](std::ptrdiff_t first, std::ptrdiff_t last) {
             double No[kMaxDegree + 1], Ni[kMaxDegree + 1];
             std::vector<double> po(pairs_outer), pi(pairs_inner);
             for (std::ptrdiff_t c = first; c < last; ++c) {
               const CellOrder::Cell& cell = cells_[c];
               double* gram = grams_.data() + c * gram_size;
               double* rhs = cell_rhs.data() + c * functions * dimension;
               for (Eigen::Index i = cell.begin; i < cell.end; ++i) {
                 const Eigen::Index k = order.points()[i];
                 const double weight = weights.size() > 0 ? weights[k] : 1.0;
                 if (weight == 0) continue;
                 outer_basis.Values(cell.outer_span, outer[k], No);
                 Ni[0] = 1;
                 if (inner_basis) inner_basis->Values(cell.inner_span, inner[k], Ni);
                 Pairs(No, p, po.data());
                 Pairs(Ni, q, pi.data());
                 if (p == 3 && q == 3) {
                   Rank1<10>(gram, po.data(), 10, pi.data(), 10, weight);
                 } else {
                   Rank1<0>(gram, po.data(), pairs_outer, pi.data(), pairs_inner, weight);
                 }
                 for (int d = 0; d < dimension; ++d) {
                   const double z = weight * values(d, k);
                   for (int r = 0; r <= p; ++r) {
                     for (int s = 0; s <= q; ++s)
                       rhs[d * functions + r * (q + 1) + s] += z * No[r] * Ni[s];
                   }
                 }
                 cell_squares[c] += weight * values.col(k).squaredNorm();
               }
             }
           });

  const int inner_size = inner_basis ? DistinctCount(*inner_basis) : 1;
  rhs_ = Eigen::MatrixXd::Zero(Eigen::Index{DistinctCount(outer_basis)} * inner_size, dimension);
  for (size_t c = 0; c < cells_.size(); ++c) {
    const double* rhs = cell_rhs.data() + c * functions * dimension;
    const int* columns = inner_rows_.data() + (cells_[c].inner_span - q);
    for (int d = 0; d < dimension; ++d) {
      for (int r = 0; r <= p; ++r) {
        const Eigen::Index row =
            Eigen::Index{outer_rows_[static_cast<size_t>(cells_[c].outer_span - p + r)]} *
            inner_size;
        for (int s = 0; s <= q; ++s)
          rhs_(row + columns[s], d) += rhs[d * functions + r * (q + 1) + s];
      }
    }
    squares_ += cell_squares[c];
    const double* gram = grams_.data() + c * gram_size;
    for (int r = 0, a = 0; r <= p; a += p + 1 - r, ++r) {
      for (int s = 0, b = 0; s <= q; b += q + 1 - s, ++s) trace_ += gram[a * pairs_inner + b];
    }
  }
}

void NormalEquations::AddTo(BlockBandedMatrix& matrix) const {
  const int p = degree_outer_, q = degree_inner_;
  const int pairs_inner = (q + 1) * (q + 2) / 2;
  const size_t gram_size = static_cast<size_t>((p + 1) * (p + 2) / 2) * pairs_inner;
  for (size_t c = 0; c < cells_.size(); ++c) {
    const double* gram = grams_.data() + c * gram_size;
    const int row0 = cells_[c].outer_span - p;
    const int* columns = inner_rows_.data() + (cells_[c].inner_span - q);
    for (int r = 0, a = 0; r <= p; ++r) {
      for (int r2 = r; r2 <= p; ++r2, ++a) {
        // Two functions of one coefficient meet on the diagonal, from either side.
        const int row = outer_rows_[static_cast<size_t>(row0 + r)],
                  row2 = outer_rows_[static_cast<size_t>(row0 + r2)];
        const double times = row == row2 && r != r2 ? 2 : 1;
        auto block = matrix.at(std::max(row, row2), std::abs(row2 - row));
        const double* pair = gram + a * pairs_inner;
        for (int s = 0, b = 0; s <= q; ++s) {
          const int column = columns[s];
          block(column, column) += times * pair[b++];
          for (int s2 = s + 1; s2 <= q; ++s2, ++b) {
            block(columns[s2], column) += times * pair[b];
            block(column, columns[s2]) += times * pair[b];
          }
        }
      }
    }
  }
}

BlockBandedMatrix EmptyMatrix(const SplineBasis& outer_basis, const SplineBasis* inner_basis) {
  const CoefficientOrder order(outer_basis);
  return BlockBandedMatrix(
      order.count(), inner_basis ? DistinctCount(*inner_basis) : 1, order.bandwidth());
}

}  // namespace batten
