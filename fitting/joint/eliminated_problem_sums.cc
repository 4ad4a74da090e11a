// SPDX-License-Identifier: MIT
// Sums over the points of each knot cell where only control points are free.
#include <algorithm>

#include "fitting/joint/eliminated_problem.h"
#include "fitting/joint/joint_kernels.h"

namespace batten::internal {
namespace {

constexpr Eigen::Index kSumBatch = 64;  // points that are handed to the kernel at once

// The points of a batch as the kernel takes them.
struct Batch {
  Batch(int p, int q)
      : Nu(static_cast<size_t>(kSumBatch * (p + 1))),
        Nv(static_cast<size_t>(kSumBatch * (q + 1)), 1.0) {}

  std::vector<double> Nu, Nv;
  double metrics[kSumBatch * kMetricLanes], pulls[kSumBatch * kPullLanes];
};

// scale · Σ d dᵀ over the directions that count, as the kernel lays it out.
void FillMetric(const FootPointSet& feet, Eigen::Index k, double scale, double* metric) {
  std::fill_n(metric, kMetricLanes, 0.0);
  metric[6] = scale;
  const int kept = feet.directions[static_cast<size_t>(k)];
  if (kept == 0) {
    metric[0] = metric[3] = metric[5] = scale;
    return;
  }
  const Eigen::Index dim = feet.difference.rows();
  for (int which = 0; which < kept; ++which) {
    const double* from = (which == 0 ? feet.first : feet.second).data() + k * dim;
    const double d[3] = {from[0], from[1], dim > 2 ? from[2] : 0.0};
    for (int i = 0, e = 0; i < 3; ++i) {
      for (int j = i; j < 3; ++j) metric[e++] += scale * d[i] * d[j];
    }
  }
}

// factor · M · difference.
void FillPull(
    const FootPointSet& feet, Eigen::Index k, const double* metric, double factor, double* pull) {
  const Eigen::Index dim = feet.difference.rows();
  const double* from = feet.difference.data() + k * dim;
  const double r[3] = {factor * from[0], factor * from[1], dim > 2 ? factor * from[2] : 0.0};
  pull[0] = metric[0] * r[0] + metric[1] * r[1] + metric[2] * r[2];
  pull[1] = metric[1] * r[0] + metric[3] * r[1] + metric[4] * r[2];
  pull[2] = metric[2] * r[0] + metric[4] * r[1] + metric[5] * r[2];
  pull[3] = 0;
}

}  // namespace

size_t EliminatedProblem::pairs_length() const {
  return static_cast<size_t>(PairCount(shape_.basis_u.degree())) * PairCount(shape_.degree_v()) *
         kMetricLanes;
}

size_t EliminatedProblem::sums_length() const {
  return pairs_length() + static_cast<size_t>(functions_) * kPullLanes;
}

EliminatedProblem::Sums EliminatedProblem::SumsOf(int cell) const {
  const Cell& of = cells_[static_cast<size_t>(cell)];
  const double* begin = sums_.data() + sums_length() * static_cast<size_t>(cell);
  return {of.span_u, of.span_v, begin, begin + pairs_length(), of.fairness, of.regularized};
}

void EliminatedProblem::SumPoints() {
  const size_t length = sums_length();
  sums_.resize(length * cells_.size());
  pool_.For(cells(), 4, [&](std::ptrdiff_t first, std::ptrdiff_t last) {
    for (std::ptrdiff_t c = first; c < last; ++c) {
      double* sums = sums_.data() + length * static_cast<size_t>(c);
      SumCell(cells_[c], sums);
      cells_[c].proximal = ProximalOfSums(cells_[c], sums);
    }
  });
}

void EliminatedProblem::SumCell(const Cell& cell, double* sums) const {
  const int p = shape_.basis_u.degree(), q = shape_.degree_v();
  std::fill_n(sums, sums_length(), 0.0);
  if (cell.begin == cell.end) return;
  Batch batch(p, q);
  std::vector<double> w(static_cast<size_t>(functions_));
  for (int a = 0; a < functions_; ++a)
    w[a] = function_weight(shape_.ControlPoint(cell.span_u, cell.span_v, a));
  for (Eigen::Index begin = cell.begin; begin < cell.end; begin += kSumBatch) {
    Eigen::Index filled = 0;
    for (Eigen::Index i = begin; i < std::min(begin + kSumBatch, cell.end); ++i) {
      const Eigen::Index k = order_[static_cast<size_t>(i)];
      const double weight = Weight(k);
      if (weight == 0) continue;
      double* Nu = batch.Nu.data() + filled * (p + 1);
      double* Nv = batch.Nv.data() + filled * (q + 1);
      shape_.basis_u.Values(cell.span_u, foot_points_.parameters(0, k), Nu);
      if (shape_.basis_v) shape_.basis_v->Values(cell.span_v, foot_points_.parameters(1, k), Nv);
      double sum = 1;
      if (rational_) {
        sum = 0;
        for (int a = 0; a < functions_; ++a) sum += w[a] * Nu[a / (q + 1)] * Nv[a % (q + 1)];
      }
      double* metric = batch.metrics + filled * kMetricLanes;
      FillMetric(foot_points_, k, weight / (sum * sum), metric);
      FillPull(foot_points_, k, metric, sum, batch.pulls + filled * kPullLanes);
      ++filled;
    }
    AddCellProducts(p,
                    q,
                    batch.Nu.data(),
                    batch.Nv.data(),
                    batch.metrics,
                    batch.pulls,
                    filled,
                    sums,
                    sums + pairs_length());
  }
}

// Calls use(a, b, weight, metric) for all pairs b ≤ a of the cell's functions: the sum over its
// points of R_a R_b times their metrics is weight · metric.
template <typename Use>
void EliminatedProblem::ForPairs(const Cell& cell, const double* pairs, const Use& use) const {
  const int p = shape_.basis_u.degree(), q = shape_.degree_v(), outer = PairCount(p);
  for (int a = 0; a < functions_; ++a) {
    const double wa = function_weight(shape_.ControlPoint(cell.span_u, cell.span_v, a));
    for (int b = 0; b <= a; ++b) {
      const int s = b % (q + 1), s2 = a % (q + 1);
      const int i = PairIndex(p, b / (q + 1), a / (q + 1));
      const int j = PairIndex(q, std::min(s, s2), std::max(s, s2));
      const double wb = function_weight(shape_.ControlPoint(cell.span_u, cell.span_v, b));
      use(a, b, wa * wb, pairs + (j * outer + i) * kMetricLanes);
    }
  }
}

// How far the shape at the accepted parameters moves with the control points of the cell, the same
// for every coordinate.
Eigen::MatrixXd EliminatedProblem::ProximalOfSums(const Cell& cell, const double* pairs) const {
  Eigen::MatrixXd form(functions_, functions_);
  ForPairs(cell, pairs, [&](int a, int b, double weight, const double* metric) {
    form(a, b) = form(b, a) = weight * metric[6];
  });
  return form;
}

void EliminatedProblem::AddSums(const Cell& cell, Eigen::MatrixXd& form) const {
  constexpr int kEntry[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
  const int dim = dimension(), n = local_columns();
  const Sums sums = SumsOf(static_cast<int>(&cell - cells_.data()));
  ForPairs(cell, sums.pairs, [&](int a, int b, double weight, const double* metric) {
    for (int d = 0; d < dim; ++d) {
      for (int e = 0; e < dim; ++e) form(dim * a + d, dim * b + e) += weight * metric[kEntry[d][e]];
    }
  });
  for (int a = 0; a < functions_; ++a) {
    const double weight = function_weight(shape_.ControlPoint(cell.span_u, cell.span_v, a));
    for (int d = 0; d < dim; ++d) form(n, dim * a + d) += weight * sums.pulls[a * kPullLanes + d];
  }
}

double EliminatedProblem::Cost(double of_damping) const {
  std::vector<double> costs(cells_.size());
  pool_.For(cells(), 8, [&](std::ptrdiff_t first, std::ptrdiff_t last) {
    for (std::ptrdiff_t c = first; c < last; ++c)
      costs[static_cast<size_t>(c)] = CellCost(cells_[static_cast<size_t>(c)], of_damping);
  });
  double cost = 0;
  for (const double c : costs) cost += c / 2;
  return cost;
}

}  // namespace batten::internal
