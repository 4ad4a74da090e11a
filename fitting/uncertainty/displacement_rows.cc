// SPDX-License-Identifier: MIT
#include "fitting/uncertainty/displacement_rows.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "batten/fitting/poles.h"
#include "fitting/least_squares/fairness.h"
#include "fitting/linear/coefficient_order.h"

namespace batten::internal {
namespace {

constexpr double kKnotStep = 1e-5;  // of the shorter gap: half of the digits

// Whether rows of control points next to held edges hold this one.
bool Held(const std::vector<HeldEdge>& edges, int i, int j, int count_u, int count_v) {
  return std::any_of(edges.begin(), edges.end(), [&](const HeldEdge& held) {
    const int at = held.edge.direction == Direction::kU ? i : j;
    const int count = held.edge.direction == Direction::kU ? count_u : count_v;
    return held.edge.upper ? at >= count - held.rows : at < held.rows;
  });
}

// The basis with one knot moved, and over a period all that repeat it.
SplineBasis WithKnot(const SplineBasis& basis, int index, double by) {
  std::vector<double> knots = basis.knots();
  const int count = static_cast<int>(knots.size());
  const int period = basis.periodic() ? DistinctCount(basis) : count;
  for (int k = index % period; k < count; k += period) knots[static_cast<size_t>(k)] += by;
  return basis.periodic() ? SplineBasis::Periodic(basis.degree(), std::move(knots))
                          : SplineBasis(basis.degree(), std::move(knots));
}

}  // namespace

DisplacementRows::DisplacementRows(SplineShape shape, const FitEstimator& estimator)
    : shape_(std::move(shape)) {
  MapCoefficients(estimator);
  first_weight_ = unknowns_;
  weight_.assign(map_.size(), -1);
  if (estimator.freed.weights) {
    const int size_v = shape_.size_v();
    const std::vector<int> of_u = DistinctIndices(&shape_.u);
    const std::vector<int> of_v = DistinctIndices(shape_.v ? &*shape_.v : nullptr);
    const int distinct_v = shape_.v ? DistinctCount(*shape_.v) : 1;
    for (size_t k = 0; k < map_.size(); ++k) {
      const int i = of_u[k / static_cast<size_t>(size_v)],
                j = of_v[k % static_cast<size_t>(size_v)];
      weight_[k] = first_weight_ + i * distinct_v + j;
      unknowns_ = std::max(unknowns_, weight_[k] + 1);
    }
  }
  first_knot_ = unknowns_;
  if (estimator.freed.knots) {
    FreeKnotsOf(true);
    if (shape_.v) FreeKnotsOf(false);
  }
}

void DisplacementRows::MapCoefficients(const FitEstimator& estimator) {
  const int size_u = shape_.u.size(), size_v = shape_.size_v();
  map_.assign(static_cast<size_t>(size_u) * static_cast<size_t>(size_v), {});
  const std::vector<int> of_u = DistinctIndices(&shape_.u);
  const std::vector<int> of_v = DistinctIndices(shape_.v ? &*shape_.v : nullptr);
  const bool poles = shape_.v && estimator.poles.any();
  std::vector<bool> tied(static_cast<size_t>(size_v), false);
  if (poles) {
    TiePoles(estimator.poles);
    for (int j = 0; j < size_v; ++j)
      tied[static_cast<size_t>(j)] = !map_[static_cast<size_t>(j)].empty();
  }
  std::vector<int> unknown(map_.size(), -1);
  for (int i = 0; i < size_u; ++i) {
    for (int j = 0; j < size_v; ++j) {
      if (tied[static_cast<size_t>(j)]) continue;
      if (Held(estimator.held_edges, i, j, size_u, size_v)) continue;
      const size_t first =
          static_cast<size_t>(of_u[static_cast<size_t>(i)] * size_v + of_v[static_cast<size_t>(j)]);
      if (unknown[first] < 0) unknown[first] = unknowns_++;
      map_[static_cast<size_t>(i * size_v + j)] = {{unknown[first], 1.0}};
    }
  }
}

void DisplacementRows::TiePoles(const Poles& poles) {
  const PoleFreedom freedom = FreeVariablesOf(shape_.u, *shape_.v, poles);
  const std::vector<int> of_u = DistinctIndices(&shape_.u);
  for (const TiedRow& row : freedom.rows) {
    for (int i = 0; i < shape_.u.size(); ++i) {
      SparseRow& entries = map_[static_cast<size_t>(i * shape_.size_v() + row.j)];
      for (Eigen::Index k = 0; k < row.form.cols(); ++k)
        entries.emplace_back(static_cast<int>(row.first + k),
                             row.form(of_u[static_cast<size_t>(i)], k));
    }
  }
  unknowns_ = static_cast<int>(freedom.unknowns);
}

// Interior knots of multiplicity one; that at the seam of a period only turns the parameter.
void DisplacementRows::FreeKnotsOf(bool in_u) {
  const SplineBasis& basis = in_u ? shape_.u : *shape_.v;
  const std::vector<double>& knots = basis.knots();
  for (int k = basis.degree() + 1; k < basis.size(); ++k) {
    const auto at = static_cast<size_t>(k);
    const double gap = std::min(knots[at] - knots[at - 1], knots[at + 1] - knots[at]);
    if (!(gap > 0)) continue;
    const double step = kKnotStep * gap;
    FreeKnot knot{in_u, k, shape_, shape_, step};
    (in_u ? knot.less.u : *knot.less.v) = WithKnot(basis, k, -step);
    (in_u ? knot.more.u : *knot.more.v) = WithKnot(basis, k, step);
    knots_.push_back(std::move(knot));
    gaps_.push_back(gap);
    ++unknowns_;
  }
}

SparseRow DisplacementRows::At(double u, double v) const {
  const ShapePlace place = PlaceOn(shape_, u, v);
  const int size_v = shape_.size_v();
  SparseRow row;
  const auto add = [&](int index, double value) { row.emplace_back(index, value); };
  for (int i = 0, k = 0; i < place.count_u; ++i) {
    for (int j = 0; j < place.count_v; ++j, ++k) {
      const int index = place.Index(i, j, size_v);
      for (const auto& [unknown, factor] : map_[static_cast<size_t>(index)])
        add(unknown, factor * place.functions[k]);
      if (weight_[static_cast<size_t>(index)] < 0) continue;
      Eigen::Vector3d off = -place.position;
      off.head(shape_.points.rows()) += shape_.points.col(index);
      add(weight_[static_cast<size_t>(index)], place.functions[k] * place.normal.dot(off));
    }
  }
  for (size_t k = 0; k < knots_.size(); ++k) {
    const FreeKnot& knot = knots_[k];
    const int span = knot.in_u ? place.span_u : place.span_v;
    const int degree = knot.in_u ? shape_.u.degree() : shape_.v->degree();
    const SplineBasis& basis = knot.in_u ? shape_.u : *shape_.v;
    const int period = DistinctCount(basis);
    const auto acts = [&](int index) { return index > span - degree && index <= span + degree; };
    if (!acts(knot.index) &&
        !(basis.periodic() && (acts(knot.index - period) || acts(knot.index + period))))
      continue;
    const Eigen::Vector3d change =
        PlaceOn(knot.more, u, v).position - PlaceOn(knot.less, u, v).position;
    add(first_knot_ + static_cast<int>(k), place.normal.dot(change) / (2 * knot.step));
  }
  return Merged(std::move(row));
}

Eigen::SparseMatrix<double> DisplacementRows::Fairness(FairnessEnergy energy) const {
  const int size_v = shape_.size_v(), degree_v = shape_.v ? shape_.v->degree() : 0;
  std::vector<Eigen::Triplet<double>> entries;
  for (const EnergyTerm& term : EnergyTerms(energy, shape_.u.degree(), degree_v)) {
    const Eigen::MatrixXd u = DerivativeGram(shape_.u, term.outer);
    const Eigen::MatrixXd v =
        shape_.v ? DerivativeGram(*shape_.v, term.inner) : Eigen::MatrixXd::Ones(1, 1);
    const auto reach_u = static_cast<int>(u.cols()) - 1, reach_v = static_cast<int>(v.cols()) - 1;
    for (int i = 0; i < u.rows(); ++i) {
      for (int a = -std::min(i, reach_u); a <= reach_u && i + a < u.rows(); ++a) {
        const double in_u = term.factor * u(std::min(i, i + a), std::abs(a));
        for (int j = 0; j < v.rows(); ++j) {
          for (int b = -std::min(j, reach_v); b <= reach_v && j + b < v.rows(); ++b)
            entries.emplace_back(i * size_v + j,
                                 (i + a) * size_v + j + b,
                                 in_u * v(std::min(j, j + b), std::abs(b)));
        }
      }
    }
  }
  const auto count = static_cast<Eigen::Index>(map_.size());
  Eigen::SparseMatrix<double> form(count, count);
  form.setFromTriplets(entries.begin(), entries.end());
  return form;
}

Eigen::SparseMatrix<double> DisplacementRows::Map() const {
  std::vector<Eigen::Triplet<double>> entries;
  for (size_t k = 0; k < map_.size(); ++k) {
    for (const auto& [unknown, factor] : map_[k])
      entries.emplace_back(static_cast<int>(k), unknown, factor);
  }
  Eigen::SparseMatrix<double> map(static_cast<Eigen::Index>(map_.size()), unknowns_);
  map.setFromTriplets(entries.begin(), entries.end());
  return map;
}

}  // namespace batten::internal
