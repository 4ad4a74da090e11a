// SPDX-License-Identifier: MIT
#include "fitting/joint/gauss_newton_system.h"

#include <algorithm>
#include <utility>

#include "fitting/joint/joint_kernels.h"
#include "fitting/linear/coefficient_order.h"

namespace batten::internal {
namespace {

// Shares of the diagonal: a ridge that only keeps the factorisation from failing.
constexpr double kRidge = 1e-8, kLeastDiagonal = 1e-6, kRaise = 100, kMostRidge = 1e-2;

// Which direction of the net is the outer one of the matrix.
bool UOutside(const TensorShape& shape) {
  if (!shape.basis_v) return true;
  const auto work = [](const SplineBasis& outer, const SplineBasis& inner) {
    const double row = DistinctCount(inner), band = CoefficientOrder(outer).bandwidth();
    return DistinctCount(outer) * (band + 1) * (band + 2) * row * row * row;
  };
  return work(shape.basis_u, *shape.basis_v) <= work(*shape.basis_v, shape.basis_u);
}

BlockBandedMatrix MatrixOf(const TensorShape& shape, bool u_outside) {
  const SplineBasis& outer = u_outside ? shape.basis_u : *shape.basis_v;
  const int inner = !shape.basis_v ? 1 : DistinctCount(u_outside ? *shape.basis_v : shape.basis_u);
  return BlockBandedMatrix(
      DistinctCount(outer), inner * shape.dimension(), CoefficientOrder(outer).bandwidth());
}

}  // namespace

GaussNewtonSystem::GaussNewtonSystem(const EliminatedProblem& cells,
                                     std::vector<bool> fixed,
                                     ThreadPool& pool)
    : cells_(cells),
      pool_(pool),
      fixed_(std::move(fixed)),
      u_outside_(UOutside(cells.shape())),
      matrix_(MatrixOf(cells.shape(), u_outside_)),
      cells_of_row_(static_cast<size_t>(matrix_.blocks())) {
  const TensorShape& shape = cells.shape();
  const SplineBasis* v = shape.basis_v ? &*shape.basis_v : nullptr;
  const std::vector<int> rows = u_outside_ ? CoefficientOrder(shape.basis_u).Rows(shape.basis_u)
                                           : CoefficientOrder(*v).Rows(*v);
  const std::vector<int> places = u_outside_ ? DistinctIndices(v) : DistinctIndices(&shape.basis_u);
  for (int i = 0; i < shape.basis_u.size(); ++i) {
    for (int j = 0; j < shape.size_v(); ++j) {
      row_of_.push_back(rows[static_cast<size_t>(u_outside_ ? i : j)]);
      place_of_.push_back(places[static_cast<size_t>(u_outside_ ? j : i)]);
    }
  }
  for (int cell = 0; cell < cells.cells(); ++cell) {
    for (const Function& function : FunctionsOf(cells.SumsOf(cell))) {
      std::vector<int>& of_row = cells_of_row_[static_cast<size_t>(function.row)];
      if (of_row.empty() || of_row.back() != cell) of_row.push_back(cell);
    }
  }
}

std::vector<GaussNewtonSystem::Function> GaussNewtonSystem::FunctionsOf(
    const EliminatedProblem::Sums& sums) const {
  std::vector<Function> functions;
  for (int a = 0; a < cells_.functions(); ++a) {
    const int point = cells_.shape().ControlPoint(sums.span_u, sums.span_v, a);
    const int block = cells_.BlockOf(point);
    functions.push_back({row_of_[static_cast<size_t>(point)],
                         place_of_[static_cast<size_t>(point)],
                         block,
                         fixed_[static_cast<size_t>(block)],
                         cells_.function_weight(point)});
  }
  return functions;
}

void GaussNewtonSystem::Refresh() {
  const TensorShape& shape = cells_.shape();
  const int dim = cells_.dimension();
  gradient_.setZero(matrix_.size());
  Eigen::MatrixXd corner(dim, cells_.functions());
  for (int cell = 0; cell < cells_.cells(); ++cell) {
    const EliminatedProblem::Sums sums = cells_.SumsOf(cell);
    const std::vector<Function> functions = FunctionsOf(sums);
    Eigen::MatrixXd pull = Eigen::MatrixXd::Zero(dim, cells_.functions());
    if (sums.fairness.size() > 0) {
      for (int a = 0; a < cells_.functions(); ++a)
        corner.col(a) = shape.net.col(shape.ControlPoint(sums.span_u, sums.span_v, a));
      pull.noalias() = sums.regularized * corner * sums.fairness;
    }
    for (int a = 0; a < cells_.functions(); ++a) {
      const Function& function = functions[static_cast<size_t>(a)];
      if (function.fixed) continue;
      double* to = gradient_.data() + function.row * matrix_.block_size() + dim * function.place;
      for (int d = 0; d < dim; ++d)
        to[d] += pull(d, a) + function.weight * sums.pulls[a * kPullLanes + d];
    }
  }
}

// Adds a cell's part to one block row of the matrix.
void GaussNewtonSystem::AddCell(int cell, int row, double damping) {
  const EliminatedProblem::Sums sums = cells_.SumsOf(cell);
  const std::vector<Function> functions = FunctionsOf(sums);
  const TensorShape& shape = cells_.shape();
  const int dim = cells_.dimension(), p = shape.basis_u.degree(), q = shape.degree_v();
  const int pairs = PairCount(p), f = cells_.functions();
  for (int a = 0; a < f; ++a) {
    const Function& of_a = functions[static_cast<size_t>(a)];
    if (of_a.row != row || of_a.fixed) continue;
    const int r = a / (q + 1), s = a % (q + 1);
    for (int b = 0; b < f; ++b) {
      const Function& of_b = functions[static_cast<size_t>(b)];
      if (of_b.row > row || of_b.fixed) continue;
      const int r2 = b / (q + 1), s2 = b % (q + 1);
      const int i = PairIndex(p, std::min(r, r2), std::max(r, r2));
      const int j = PairIndex(q, std::min(s, s2), std::max(s, s2));
      const double* m = sums.pairs + (j * pairs + i) * kMetricLanes;
      const double w = of_a.weight * of_b.weight;
      const double even = w * damping * m[6] +
                          (sums.fairness.size() > 0 ? sums.regularized * sums.fairness(a, b) : 0.0);
      auto block = matrix_.at(row, row - of_b.row);
      const Eigen::Index size = block.outerStride();
      double* to = block.data() + dim * of_b.place * size + dim * of_a.place;
      to[0] += w * m[0] + even;
      to[1] += w * m[1];
      to[size] += w * m[1];
      to[size + 1] += w * m[3] + even;
      if (dim == 2) continue;
      to[2] += w * m[2];
      to[size + 2] += w * m[4];
      to[2 * size] += w * m[2];
      to[2 * size + 1] += w * m[4];
      to[2 * size + 2] += w * m[5] + even;
    }
  }
}

void GaussNewtonSystem::Fill(double damping) {
  pool_.For(matrix_.blocks(), 1, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (std::ptrdiff_t k = begin; k < end; ++k) {
      const int row = static_cast<int>(k);
      for (int below = 0; below <= std::min(row, matrix_.bandwidth()); ++below)
        matrix_.at(row, below).setZero();
      for (const int cell : cells_of_row_[static_cast<size_t>(row)]) AddCell(cell, row, damping);
    }
  });
}

std::optional<GaussNewtonSystem::Step> GaussNewtonSystem::Solve(double damping) {
  const int dim = cells_.dimension(), size = matrix_.block_size();
  Eigen::VectorXd ridges(matrix_.size());
  Eigen::MatrixXd solution;
  bool solved = false;
  for (double ridge = kRidge; !solved && ridge <= kMostRidge; ridge *= kRaise) {
    Fill(damping);
    for (int row = 0; row < matrix_.blocks(); ++row) {
      auto diagonal = matrix_.at(row, 0).diagonal();
      for (int k = 0; k < size; ++k) {
        double& more = ridges[row * size + k];
        more = ridge * std::max(diagonal[k], kLeastDiagonal);
        diagonal[k] += more;
      }
    }
    if (!matrix_.Factor(&pool_)) continue;
    solution = -gradient_;
    matrix_.Solve(solution);
    solved = solution.allFinite();
  }
  if (!solved) return std::nullopt;
  // With (H + D) s = −g the model falls by −g·s − s·H·s/2 = (−g·s + s·D·s)/2.
  const Eigen::VectorXd s = solution.col(0);
  Step step{Eigen::MatrixXd(dim, cells_.blocks()),
            (s.dot(ridges.cwiseProduct(s)) - s.dot(gradient_)) / 2};
  for (size_t point = 0; point < row_of_.size(); ++point) {
    step.net.col(cells_.BlockOf(static_cast<int>(point))) =
        s.segment(Eigen::Index{row_of_[point]} * size + Eigen::Index{dim} * place_of_[point], dim);
  }
  return step;
}

}  // namespace batten::internal
