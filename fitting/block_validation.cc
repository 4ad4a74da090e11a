// SPDX-License-Identifier: MIT
#include "batten/fitting/block_validation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "batten/fitting/coefficient_order.h"
#include "batten/fitting/fairness.h"
#include "batten/fitting/normal_equations.h"
#include "batten/fitting/pole_rows.h"

namespace batten {
namespace {

constexpr int kFolds = 5;
constexpr double kPointsToSeeArea =
    9;  // a tile that holds this many on average is hardly ever missed

// Square tiles over the domain, those at its rim cut in half.
class Tiles {
 public:
  Tiles(const FittingProblem& problem, double width)
      : low_u_(problem.basis_u().lower()),
        low_v_(problem.basis_v().lower()),
        width_(width),
        rows_(Count(problem.basis_v().upper() - low_v_)) {
    columns_ = Count(problem.basis_u().upper() - low_u_);
  }

  int Column(double u) const { return Place(u - low_u_, columns_); }
  int Row(double v) const { return Place(v - low_v_, rows_); }
  Eigen::Index Of(double u, double v) const { return Column(u) * rows_ + Row(v); }
  Eigen::Index size() const { return columns_ * rows_; }

 private:
  Eigen::Index Count(double length) const {
    return static_cast<Eigen::Index>(std::floor(length / width_ + 0.5)) + 1;
  }
  int Place(double distance, Eigen::Index count) const {
    return static_cast<int>(
        std::clamp<Eigen::Index>(static_cast<Eigen::Index>(distance / width_ + 0.5), 0, count - 1));
  }

  double low_u_, low_v_, width_;
  Eigen::Index rows_, columns_;
};

// Every fifth tile of a row, moved on by two from row to row: no two of a fold touch.
int FoldOf(int column, int row) { return (column + 2 * row) % kFolds; }

double Area(const FittingProblem& problem) {
  return (problem.basis_u().upper() - problem.basis_u().lower()) *
         (problem.basis_v().upper() - problem.basis_v().lower());
}

// |S − z|² at every point; a coefficient of the net in a row, in the order of the solver.
Eigen::VectorXd SquaredErrors(const SplineBasis& outer,
                              const SplineBasis& inner,
                              const Eigen::VectorXd& a,
                              const Eigen::VectorXd& b,
                              const Eigen::MatrixXd& values,
                              const CellOrder& order,
                              const Eigen::MatrixXd& net,
                              ThreadPool& pool) {
  const std::vector<int> outer_rows = CoefficientOrder(outer).Rows(outer),
                         inner_rows = DistinctIndices(&inner);
  const Eigen::Index columns = DistinctCount(inner);
  const int p = outer.degree(), q = inner.degree();
  Eigen::VectorXd squares(values.cols());
  pool.For(std::ssize(order.cells()), 8, [&](std::ptrdiff_t first, std::ptrdiff_t last) {
    double No[kMaxDegree + 1], Ni[kMaxDegree + 1];
    for (std::ptrdiff_t c = first; c < last; ++c) {
      const CellOrder::Cell& cell = order.cells()[static_cast<size_t>(c)];
      const int* rows = outer_rows.data() + (cell.outer_span - p);
      const int* places = inner_rows.data() + (cell.inner_span - q);
      for (Eigen::Index i = cell.begin; i < cell.end; ++i) {
        const Eigen::Index k = order.points()[static_cast<size_t>(i)];
        outer.Values(cell.outer_span, a[k], No);
        inner.Values(cell.inner_span, b[k], Ni);
        squares[k] = 0;
        for (Eigen::Index d = 0; d < values.rows(); ++d) {
          double error = -values(d, k);
          for (int r = 0; r <= p; ++r) {
            for (int s = 0; s <= q; ++s)
              error += No[r] * Ni[s] * net(columns * rows[r] + places[s], d);
          }
          squares[k] += error * error;
        }
      }
    }
  });
  return squares;
}

}  // namespace

double ParameterSpacing(const FittingProblem& problem) {
  const auto count = static_cast<double>(std::max<Eigen::Index>(problem.size(), 1));
  const double width = std::sqrt(Area(problem) * kPointsToSeeArea / count);
  const Tiles tiles(problem, width);
  std::vector<bool> full(static_cast<size_t>(tiles.size()), false);
  for (Eigen::Index k = 0; k < problem.size(); ++k) {
    full[static_cast<size_t>(
        tiles.Of(problem.data().parameters(0, k), problem.data().parameters(1, k)))] = true;
  }
  const auto share = static_cast<double>(std::count(full.begin(), full.end(), true)) /
                     static_cast<double>(full.size());
  return std::sqrt(Area(problem) * share / count);
}

BlockValidation::BlockValidation(const FittingProblem& problem, double width)
    : folds_(kFolds), smoothing_(problem.smoothing()), poles_(problem.poles()) {
  if (problem.is_curve()) throw std::invalid_argument("BlockValidation: a curve has no blocks");
  if (!(width > 0)) {
    throw std::invalid_argument("BlockValidation: width is " + std::to_string(width) +
                                ", not positive");
  }
  const FittingData& data = problem.data();
  const Tiles tiles(problem, width);
  std::vector<int> fold_of(static_cast<size_t>(problem.size()));
  std::vector<int> number(static_cast<size_t>(tiles.size()), -1);
  std::vector<Eigen::Index> sizes(kFolds, 0);
  for (Eigen::Index k = 0; k < problem.size(); ++k) {
    const double u = data.parameters(0, k), v = data.parameters(1, k);
    fold_of[static_cast<size_t>(k)] = FoldOf(tiles.Column(u), tiles.Row(v));
    ++sizes[static_cast<size_t>(fold_of[static_cast<size_t>(k)])];
    number[static_cast<size_t>(tiles.Of(u, v))] = 0;
  }
  for (int& n : number) {
    if (n == 0) n = blocks_++;
  }
  for (int f = 0; f < kFolds; ++f) {
    Fold& fold = folds_[static_cast<size_t>(f)];
    const Eigen::Index size = sizes[static_cast<size_t>(f)];
    fold.u.resize(size);
    fold.v.resize(size);
    fold.values.resize(data.values.rows(), size);
    if (data.weights.size() > 0) fold.weights.resize(size);
    fold.block.reserve(static_cast<size_t>(size));
  }
  block_of_.reserve(static_cast<size_t>(problem.size()));
  for (Eigen::Index k = 0; k < problem.size(); ++k) {
    Fold& fold = folds_[static_cast<size_t>(fold_of[static_cast<size_t>(k)])];
    const Eigen::Index to = std::ssize(fold.block);
    fold.u[to] = data.parameters(0, k);
    fold.v[to] = data.parameters(1, k);
    fold.values.col(to) = data.values.col(k);
    if (data.weights.size() > 0) fold.weights[to] = data.weights[k];
    fold.block.push_back(number[static_cast<size_t>(tiles.Of(fold.u[to], fold.v[to]))]);
    block_of_.push_back(fold.block.back());
  }
}

Eigen::VectorXd BlockValidation::Errors(const SplineBasis& basis_u,
                                        const SplineBasis& basis_v,
                                        ThreadPool& pool) const {
  const bool u_outside = basis_u.size() >= basis_v.size();
  const SplineBasis &outer = u_outside ? basis_u : basis_v, &inner = u_outside ? basis_v : basis_u;
  std::vector<CellOrder> orders;
  std::vector<NormalEquations> equations;
  double trace = 0;
  for (const Fold& fold : folds_) {
    const Eigen::VectorXd &a = u_outside ? fold.u : fold.v, &b = u_outside ? fold.v : fold.u;
    orders.emplace_back(outer, &inner, a, b);
    equations.emplace_back(outer, &inner, a, b, fold.values, fold.weights, orders.back(), pool);
    trace += equations.back().trace();
  }
  const FairnessForm fairness(outer, &inner);
  const Eigen::MatrixXd conditions = PoleConditionsOnRows(basis_u, basis_v, poles_, u_outside);
  Eigen::VectorXd errors = Eigen::VectorXd::Zero(blocks_);
  for (size_t f = 0; f < folds_.size(); ++f) {
    const Fold& fold = folds_[f];
    if (fold.block.empty()) continue;
    BlockBandedMatrix matrix = EmptyMatrix(outer, &inner);
    Eigen::MatrixXd net = Eigen::MatrixXd::Zero(matrix.size(), fold.values.rows());
    for (size_t other = 0; other < folds_.size(); ++other) {
      if (other == f) continue;
      equations[other].AddTo(matrix);
      net += equations[other].rhs();
    }
    if (smoothing_ > 0) fairness.AddTo(matrix, smoothing_ * trace / fairness.Trace());
    matrix.AddToDiagonal(4 * std::numeric_limits<double>::epsilon() * trace / matrix.size());
    if (!matrix.Factor()) {
      return Eigen::VectorXd::Constant(blocks_, std::numeric_limits<double>::infinity());
    }
    matrix.Solve(net);
    MeetConditions(matrix, conditions, net);
    const Eigen::VectorXd squares = SquaredErrors(outer,
                                                  inner,
                                                  u_outside ? fold.u : fold.v,
                                                  u_outside ? fold.v : fold.u,
                                                  fold.values,
                                                  orders[f],
                                                  net,
                                                  pool);
    for (Eigen::Index k = 0; k < squares.size(); ++k) {
      errors[fold.block[static_cast<size_t>(k)]] +=
          (fold.weights.size() > 0 ? fold.weights[k] : 1.0) * squares[k];
    }
  }
  return errors;
}

}  // namespace batten
