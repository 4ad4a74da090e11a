// SPDX-License-Identifier: MIT
// Evaluation of edge rows at one parameter.
#pragma once

#include <array>

#include "fitting/constraints/edge_rows.h"

namespace batten::internal {

// Values, or derivatives of an order, of one axis' B-splines at one parameter; fine ones are
// evaluated on demand.
class AxisValues {
 public:
  AxisValues(const RefinedEdgeBasis& axis, double at, int order)
      : axis_(axis), at_(at), order_(order) {
    Fill(axis.coarse, coarse_span_ = axis.coarse.Span(at), coarse_.data());
  }

  // The value of coarse function i; zero outside its support.
  double Coarse(int i) const {
    const int r = i - coarse_span_ + axis_.coarse.degree();
    return r < 0 || r > axis_.coarse.degree() ? 0.0 : coarse_[static_cast<size_t>(r)];
  }
  int first() const { return coarse_span_ - axis_.coarse.degree(); }

  // Calls add(column, value) with the value of each column of a row's curve, for one coordinate.
  template <typename Add>
  void Curve(const Eigen::SparseMatrix<double, Eigen::RowMajor>& curve, const Add& add) {
    if (fine_span_ < 0) Fill(axis_.fine, fine_span_ = axis_.fine.Span(at_), fine_.data());
    const int p = axis_.fine.degree();
    for (int r = 0; r <= p; ++r) {
      for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator it(curve,
                                                                          fine_span_ - p + r);
           it;
           ++it) {
        add(static_cast<int>(it.col()), fine_[static_cast<size_t>(r)] * it.value());
      }
    }
  }

 private:
  void Fill(const SplineBasis& basis, int span, double* to) const {
    if (order_ == 0) return basis.Values(span, at_, to);
    std::array<double, 2 * (kMaxDegree + 1)> both;
    basis.Derivatives(span, at_, 1, both.data());
    std::copy_n(both.data() + basis.degree() + 1, basis.degree() + 1, to);
  }

  const RefinedEdgeBasis& axis_;
  double at_;
  int order_;  // 0 or 1
  int coarse_span_, fine_span_ = -1;
  std::array<double, kMaxDegree + 1> coarse_, fine_;
};

// Calls add(unknown, d, value), perhaps several times, for every unknown of the rows with support
// at (u, v), with coordinate d of its value there; the unknown is −1 for the given part.
template <typename Add>
void VisitEdges(const EdgeRows& edges, AxisValues& u, AxisValues& v, const Add& add) {
  for (const EdgeRow& row : edges.rows) {
    const double profile = (row.along_u ? v : u).Coarse(row.profile);
    if (profile == 0) continue;
    for (int d = 0; d < 3; ++d) {
      (row.along_u ? u : v).Curve(row.curves[d], [&](int column, double value) {
        add(column == row.count ? -1 : row.first + column, d, profile * value);
      });
    }
  }
}

}  // namespace batten::internal
