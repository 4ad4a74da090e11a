// SPDX-License-Identifier: MIT
#include "fitting/linear/collocation.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "fitting/linear/banded_lu.h"
#include "fitting/linear/coefficient_order.h"

namespace batten::internal {
namespace {

// The functions that act in every condition, scaled so that the largest is 1.
struct Rows {
  std::vector<int> first;      // function
  std::vector<double> values;  // p + 1 each
  std::vector<double> scale;   // the values are this many times their own
};

Rows RowsOf(const SplineBasis& basis, const std::vector<SplineCondition>& conditions) {
  const int p = basis.degree();
  Rows rows;
  rows.values.resize(conditions.size() * (p + 1));
  std::vector<double> derivatives;
  for (size_t k = 0; k < conditions.size(); ++k) {
    const auto& [u, order] = conditions[k];
    const int span = basis.Span(u);
    rows.first.push_back(span - p);
    double* row = rows.values.data() + k * (p + 1);
    if (order == 0) {
      basis.Values(span, u, row);
    } else {
      derivatives.resize((order + 1) * (p + 1));
      basis.Derivatives(span, u, order, derivatives.data());
      std::copy_n(derivatives.data() + order * (p + 1), p + 1, row);
    }
    double most = 0;
    for (int r = 0; r <= p; ++r) most = std::max(most, std::abs(row[r]));
    const double scale = most > 0 ? 1 / most : 1;
    for (int r = 0; r <= p; ++r) row[r] *= scale;
    rows.scale.push_back(scale);
  }
  return rows;
}

}  // namespace

std::optional<Eigen::MatrixXd> SolveConditions(const SplineBasis& basis,
                                               const std::vector<SplineCondition>& conditions,
                                               const Eigen::MatrixXd& values,
                                               bool regular) {
  const int p = basis.degree();
  const Eigen::Index distinct = DistinctCount(basis);
  const Rows rows = RowsOf(basis, conditions);
  // Around a ring neighbours stay close, so that the matrix is banded.
  const auto place = [&](Eigen::Index i) { return basis.periodic() ? DealtPlace(i, distinct) : i; };
  // Around a ring, a condition's place is that of the middle one of its functions.
  const Eigen::Index start = basis.periodic() ? rows.first[0] + p / 2 : 0;
  const auto column = [&](Eigen::Index k, int r) {
    const Eigen::Index i = rows.first[static_cast<size_t>(k)] + r;
    return basis.periodic() ? place(((i - start) % distinct + distinct) % distinct) : i;
  };
  Eigen::Index below = 0, above = 0;
  for (Eigen::Index k = 0; k < distinct; ++k) {
    for (int r = 0; r <= p; ++r) {
      below = std::max(below, place(k) - column(k, r));
      above = std::max(above, column(k, r) - place(k));
    }
  }
  BandedLu matrix(distinct, below, above);
  RightSides solution(distinct, values.rows());
  for (Eigen::Index k = 0; k < distinct; ++k) {
    const auto row = static_cast<size_t>(k);
    for (int r = 0; r <= p; ++r) {
      matrix.at(place(k), column(k, r)) += rows.values[row * (p + 1) + r];
    }
    solution.row(place(k)) = rows.scale[row] * values.col(k).transpose();
  }
  constexpr double kSingular = 16 * std::numeric_limits<double>::epsilon();  // of rows of size 1
  if (matrix.Factor(regular ? 0 : kSingular) < distinct) return std::nullopt;
  matrix.Solve(solution);
  Eigen::MatrixXd control(values.rows(), basis.size());
  for (Eigen::Index i = 0; i < basis.size(); ++i) {
    const Eigen::Index on_ring = ((i - start) % distinct + distinct) % distinct;
    control.col(i) = solution.row(basis.periodic() ? place(on_ring) : i).transpose();
  }
  return control;
}

}  // namespace batten::internal
