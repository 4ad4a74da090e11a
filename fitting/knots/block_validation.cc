// SPDX-License-Identifier: MIT
#include "fitting/knots/block_validation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "fitting/linear/coefficient_order.h"
#include "fitting/least_squares/fairness.h"
#include "fitting/least_squares/net_values.h"
#include "fitting/least_squares/normal_equations.h"
#include "fitting/least_squares/pole_rows.h"
#include "fitting/linear/tied_system.h"

namespace batten::internal {
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
  Eigen::Index Of(int column, int row) const { return column * rows_ + row; }
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
                              const PointRows& points,
                              const Eigen::MatrixXd& values,
                              const Eigen::MatrixXd& net,
                              ThreadPool& pool) {
  const Eigen::Index columns = DistinctCount(inner);
  Eigen::MatrixXd coefficients(net.cols(), Eigen::Index{outer.size()} * inner.size());
  Eigen::Index to = 0;
  for (const int i : CoefficientOrder(outer).Rows(outer)) {
    for (const int j : DistinctIndices(&inner))
      coefficients.col(to++) = net.row(columns * i + j).transpose();
  }
  return (NetValues(outer, &inner, coefficients, points, pool) - values).colwise().squaredNorm();
}

}  // namespace

double ParameterSpacing(const FittingProblem& problem) {
  const auto count = static_cast<double>(std::max<Eigen::Index>(problem.size(), 1));
  const double width = std::sqrt(Area(problem) * kPointsToSeeArea / count);
  const Tiles tiles(problem, width);
  std::vector<bool> full(static_cast<size_t>(tiles.size()), false);
  for (Eigen::Index k = 0; k < problem.size(); ++k) {
    full[static_cast<size_t>(tiles.Of(tiles.Column(problem.data().parameters(0, k)),
                                      tiles.Row(problem.data().parameters(1, k))))] = true;
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
  std::vector<char> fold_of(static_cast<size_t>(problem.size()));
  block_of_.resize(static_cast<size_t>(problem.size()));
  std::vector<int> number(static_cast<size_t>(tiles.size()), -1);
  std::vector<Eigen::Index> sizes(kFolds, 0);
  for (Eigen::Index k = 0; k < problem.size(); ++k) {
    const double u = data.parameters(0, k), v = data.parameters(1, k);
    const int column = tiles.Column(u), row = tiles.Row(v), fold = FoldOf(column, row);
    const auto tile = static_cast<int>(tiles.Of(column, row));
    fold_of[static_cast<size_t>(k)] = static_cast<char>(fold);
    block_of_[static_cast<size_t>(k)] = tile;
    ++sizes[static_cast<size_t>(fold)];
    number[static_cast<size_t>(tile)] = 0;
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
  for (Eigen::Index k = 0; k < problem.size(); ++k) {
    Fold& fold = folds_[static_cast<size_t>(fold_of[static_cast<size_t>(k)])];
    const Eigen::Index to = std::ssize(fold.block);
    fold.u[to] = data.parameters(0, k);
    fold.v[to] = data.parameters(1, k);
    fold.values.col(to) = data.values.col(k);
    if (data.weights.size() > 0) fold.weights[to] = data.weights[k];
    int& block = block_of_[static_cast<size_t>(k)];
    block = number[static_cast<size_t>(block)];
    fold.block.push_back(block);
  }
}

Eigen::VectorXd BlockValidation::Errors(const SplineBasis& basis_u,
                                        const SplineBasis& basis_v,
                                        ThreadPool& pool) const {
  const bool u_outside = basis_u.size() >= basis_v.size();
  const SplineBasis &outer = u_outside ? basis_u : basis_v, &inner = u_outside ? basis_v : basis_u;
  std::vector<PointRows> points;
  std::vector<NormalEquations> equations;
  double trace = 0;
  for (const Fold& fold : folds_) {
    points.push_back(RowsOf(
        u_outside ? fold.u : fold.v, u_outside ? fold.v : fold.u, fold.values, fold.weights));
    equations.emplace_back(outer, &inner, points.back(), pool);
    trace += equations.back().trace();
  }
  TensorBand energy(outer.size(), inner.size(), outer.degree(), inner.degree());
  if (smoothing_ > 0) {
    const FairnessForm fairness(outer, &inner);
    fairness.AddTo(energy, smoothing_ * trace / fairness.Trace());
  }
  const std::vector<int> outer_rows = CoefficientOrder(outer).Rows(outer),
                         inner_rows = DistinctIndices(&inner);
  const NetTies ties = PoleTies(basis_u, basis_v, poles_, u_outside);
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
    energy.AddTo(matrix, outer_rows, inner_rows);
    matrix.AddToDiagonal(4 * std::numeric_limits<double>::epsilon() * trace / matrix.size());
    TiedSystem system(std::move(matrix), ties);
    if (!system.Factor(&pool)) {
      return Eigen::VectorXd::Constant(blocks_, std::numeric_limits<double>::infinity());
    }
    system.Solve(net);
    const Eigen::VectorXd squares = SquaredErrors(outer, inner, points[f], fold.values, net, pool);
    for (Eigen::Index k = 0; k < squares.size(); ++k) {
      errors[fold.block[static_cast<size_t>(k)]] +=
          (fold.weights.size() > 0 ? fold.weights[k] : 1.0) * squares[k];
    }
  }
  return errors;
}

}  // namespace batten::internal
