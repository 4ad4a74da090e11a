// SPDX-License-Identifier: MIT
#include "batten/fitting/poles.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "fitting/linear/coefficient_order.h"
#include "fitting/linear/collocation.h"
#include "geometry/numeric/dense_solvers.h"

namespace batten {
using namespace internal;
namespace {

// Columns 1, γ_1, δ_1, γ_2, δ_2 up to an order: the coefficients, of those that differ, of the
// splines that take the values of 1, cos kφ and sin kφ, φ the angle, at the Greville abscissae.
Eigen::MatrixXd Harmonics(const SplineBasis& basis, double turn, int order) {
  const int m = DistinctCount(basis), p = basis.degree();
  std::vector<SplineCondition> conditions;
  for (int i = 0; i < m; ++i) conditions.push_back({basis.Clamp(basis.Greville(i))});
  std::ranges::sort(conditions, {}, &SplineCondition::u);
  Eigen::MatrixXd values(1 + 2 * order, m);
  for (int i = 0; i < m; ++i) {
    const double u = conditions[static_cast<size_t>(i)].u;
    const double angle = turn * (u - basis.lower()) / (basis.upper() - basis.lower());
    values(0, i) = 1;
    for (int k = 1; k <= order; ++k) {
      values(2 * k - 1, i) = std::cos(k * angle);
      values(2 * k, i) = std::sin(k * angle);
    }
  }
  if (const auto control = SolveConditions(basis, conditions, values))
    return control->leftCols(m).transpose();
  // The minimum-norm solution where collocation is nearly singular.
  Eigen::MatrixXd at = Eigen::MatrixXd::Zero(m, m);
  double N[kMaxDegree + 1];
  for (int i = 0; i < m; ++i) {
    const double u = conditions[static_cast<size_t>(i)].u;
    const int span = basis.Span(u);
    basis.Values(span, u, N);
    for (int r = 0; r <= p; ++r) at(i, DistinctIndex(basis, span - p + r)) += N[r];
  }
  return LeastNormSolution(at, values.transpose());
}

// An orthonormal basis of a span of columns, as many as columns, or rows: also where, over a small
// angle, rounding tells no more of them apart.
Eigen::MatrixXd Inside(const Eigen::MatrixXd& columns) {
  return OrthogonalFactor(columns).leftCols(std::min(columns.rows(), columns.cols()));
}

// An orthonormal basis of what is orthogonal to them.
Eigen::MatrixXd Outside(const Eigen::MatrixXd& columns) {
  return OrthogonalFactor(columns).rightCols(
      std::max<Eigen::Index>(columns.rows() - columns.cols(), 0));
}

// The functional that maps 1 to one, γ and δ to zero: the mean part of a row, constant in angle.
Eigen::VectorXd MiddleForm(const Eigen::MatrixXd& round_row) {
  const Eigen::Vector3d first(1, 0, 0);
  return LeastNormSolution(round_row.transpose(), first);
}

// The rows of the net that conditions at a pole are on: the edge, the next and the one after it, as
// far as those are not the other pole's.
struct PoleRows {
  PoleKind kind;
  int edge, next, third;  // −1: none
};
std::vector<PoleRows> RowsAt(const SplineBasis& basis_v, const Poles& poles) {
  std::vector<PoleRows> rows;
  const int n = basis_v.size();
  const int ends = (poles.start != PoleKind::kNone) + (poles.end != PoleKind::kNone);
  const auto add = [&](PoleKind kind, int edge, int step) {
    if (kind == PoleKind::kNone) return;
    // At degree q, row j depends on the pole's derivatives up to the j-th only, while j < q.
    const bool second = n >= 2 + ends && basis_v.degree() > 1;
    const bool third = n >= 3 * ends && n > 3 && basis_v.degree() > 2 && kind == PoleKind::kSmooth;
    rows.push_back({kind, edge, second ? edge + step : -1, third ? edge + 2 * step : -1});
  };
  add(poles.start, 0, 1);
  add(poles.end, n - 1, -1);
  return rows;
}

// The number of unknowns of a row of m coefficients restricted to harmonics up to an order.
int KeptOf(int m, int order) { return std::min(m, 1 + 2 * order); }

}  // namespace

Eigen::MatrixXd PoleConditions(const SplineBasis& basis_u,
                               const SplineBasis& basis_v,
                               const Poles& poles) {
  const int m = DistinctCount(basis_u), size_v = DistinctCount(basis_v);
  const Eigen::Index columns = Eigen::Index{m} * size_v;
  if (!poles.any()) return Eigen::MatrixXd(0, columns);
  const Eigen::MatrixXd first = Harmonics(basis_u, poles.turn, 1);
  const Eigen::MatrixXd differ = Outside(Eigen::VectorXd::Ones(m)).transpose(),
                        off_first = Outside(first).transpose(),
                        off_second = Outside(Harmonics(basis_u, poles.turn, 2)).transpose();
  const Eigen::RowVectorXd middle = MiddleForm(first).transpose();
  Eigen::MatrixXd conditions =
      Eigen::MatrixXd::Zero(PoleConditionCount(basis_u, basis_v, poles), columns);
  const auto row_of = [&](int j) { return Eigen::seqN(j, m, size_v); };
  Eigen::Index to = 0;
  const auto add = [&](const Eigen::MatrixXd& form, int row) {
    conditions(Eigen::seqN(to, form.rows()), row_of(row)) = form;
    to += form.rows();
  };
  for (const PoleRows& end : RowsAt(basis_v, poles)) {
    add(differ, end.edge);
    if (end.third >= 0) add(off_second, end.third);
    if (end.next < 0) continue;
    add(off_first, end.next);
    if (end.kind != PoleKind::kSmooth) continue;
    conditions(to, row_of(end.next)) = middle;
    conditions(to, row_of(end.edge)).array() -= 1.0 / m;
    ++to;
  }
  return conditions;
}

int PoleConditionCount(const SplineBasis& basis_u, const SplineBasis& basis_v, const Poles& poles) {
  if (!poles.any()) return 0;
  const int m = DistinctCount(basis_u);
  int count = 0;
  for (const PoleRows& end : RowsAt(basis_v, poles)) {
    count += m - 1;
    if (end.next >= 0) count += m - KeptOf(m, 1) + (end.kind == PoleKind::kSmooth ? 1 : 0);
    if (end.third >= 0) count += m - KeptOf(m, 2);
  }
  return count;
}

PoleFreedom FreeVariablesOf(const SplineBasis& basis_u,
                            const SplineBasis& basis_v,
                            const Poles& poles) {
  PoleFreedom freedom;
  if (!poles.any()) return freedom;
  const int m = DistinctCount(basis_u);
  const Eigen::MatrixXd first = Harmonics(basis_u, poles.turn, 1);
  const Eigen::MatrixXd in_first = Inside(first),
                        in_second = Inside(Harmonics(basis_u, poles.turn, 2));
  const Eigen::VectorXd middle = in_first.transpose() * MiddleForm(first);
  const auto add = [&](int j, Eigen::Index from, const Eigen::MatrixXd& form) {
    freedom.rows.push_back({j, from, form});
    freedom.unknowns = std::max(freedom.unknowns, from + form.cols());
  };
  for (const PoleRows& end : RowsAt(basis_v, poles)) {
    const Eigen::Index pole = freedom.unknowns;
    Eigen::VectorXd edge = Eigen::VectorXd::Ones(m);
    Eigen::MatrixXd next = in_first;
    if (end.next >= 0 && end.kind == PoleKind::kSmooth) {
      // The middle of the next row is the pole: both move with one unknown.
      const Eigen::VectorXd with_pole = in_first * middle / middle.squaredNorm();
      const double length = std::sqrt(m + with_pole.squaredNorm());
      edge /= length;
      next << with_pole / length, in_first * Outside(middle);
    } else {
      edge.normalize();
    }
    add(end.edge, pole, edge);
    if (end.next >= 0) add(end.next, end.kind == PoleKind::kSmooth ? pole : pole + 1, next);
    if (end.third >= 0) add(end.third, freedom.unknowns, in_second);
  }
  return freedom;
}

Eigen::MatrixXd WithPolesClosed(Eigen::MatrixXd coefficients,
                                const SplineBasis& basis_u,
                                const SplineBasis& basis_v,
                                const Poles& poles) {
  if (!poles.any()) return coefficients;
  const int m = DistinctCount(basis_u), size_v = basis_v.size();
  const Eigen::MatrixXd first = Harmonics(basis_u, poles.turn, 1);
  const Eigen::MatrixXd in_first = Inside(first),
                        in_second = Inside(Harmonics(basis_u, poles.turn, 2));
  const Eigen::VectorXd middle = MiddleForm(first);
  const auto at = [&](int i, int j) { return Eigen::Index{i} * size_v + j; };
  const auto row_off = [&](int j, const Eigen::VectorXd& pole) {
    Eigen::MatrixXd row(m, coefficients.rows());
    for (int i = 0; i < m; ++i) row.row(i) = (coefficients.col(at(i, j)) - pole).transpose();
    return row;
  };
  const auto put = [&](int j, const Eigen::VectorXd& pole, const Eigen::MatrixXd& row) {
    for (int i = 0; i < basis_u.size(); ++i) {
      coefficients.col(at(i, j)) = pole + row.row(DistinctIndex(basis_u, i)).transpose();
    }
  };
  for (const PoleRows& end : RowsAt(basis_v, poles)) {
    Eigen::VectorXd pole = Eigen::VectorXd::Zero(coefficients.rows());
    for (int i = 0; i < m; ++i) pole += coefficients.col(at(i, end.edge)) / m;
    put(end.edge, pole, Eigen::MatrixXd::Zero(m, coefficients.rows()));
    if (end.next >= 0) {
      Eigen::MatrixXd next = in_first * (in_first.transpose() * row_off(end.next, pole));
      if (end.kind == PoleKind::kSmooth) next.rowwise() -= (middle.transpose() * next).eval();
      put(end.next, pole, next);
    }
    if (end.third >= 0) {
      put(end.third, pole, in_second * (in_second.transpose() * row_off(end.third, pole)));
    }
  }
  return coefficients;
}

}  // namespace batten
