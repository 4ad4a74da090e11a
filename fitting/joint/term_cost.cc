// SPDX-License-Identifier: MIT
#include "fitting/joint/term_cost.h"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace batten::internal {
namespace {

// The blocks of some control points, each once, in the order of their first mention.
std::vector<int> BlocksOf(const std::vector<int>& points, const EliminatedProblem& cells) {
  std::vector<int> blocks;
  for (const int point : points) {
    const int block = cells.BlockOf(point);
    if (std::find(blocks.begin(), blocks.end(), block) == blocks.end()) blocks.push_back(block);
  }
  return blocks;
}

void CheckIndices(const std::vector<int>& indices, const EliminatedProblem& cells) {
  for (const int k : indices) {
    if (k < 0 || k >= cells.shape().net.cols()) {
      throw std::invalid_argument("Optimize: a residual term names control point " +
                                  std::to_string(k) + ", not in [0, " +
                                  std::to_string(cells.shape().net.cols() - 1) + "]");
    }
  }
}

}  // namespace

TermCost::TermCost(std::shared_ptr<const ResidualTerm> term,
                   const EliminatedProblem& cells,
                   double unit)
    : term_(std::move(term)), cells_(cells), unit_(unit) {
  if (!term_ || term_->residuals() < 1) {
    throw std::invalid_argument("Optimize: a residual term has no residual");
  }
  points_ = term_->ControlPoints();
  weights_ = term_->Weights();
  CheckIndices(points_, cells);
  CheckIndices(weights_, cells);
  point_blocks_ = BlocksOf(points_, cells);
  if (cells.free_weights()) weight_blocks_ = BlocksOf(weights_, cells);
  set_num_residuals(term_->residuals());
  for (size_t k = 0; k < point_blocks_.size(); ++k)
    mutable_parameter_block_sizes()->push_back(cells.dimension());
  for (size_t k = 0; k < weight_blocks_.size(); ++k) mutable_parameter_block_sizes()->push_back(1);
  for (int d = 0; d < 2; ++d) {
    knots_[d] = term_->needs_knots() && d < cells.directions() && cells.free_knots(d);
    if (knots_[d]) mutable_parameter_block_sizes()->push_back(cells.gaps(d));
  }
}

std::vector<double*> TermCost::Blocks(EliminatedProblem& cells) const {
  std::vector<double*> blocks;
  for (const int block : point_blocks_) blocks.push_back(cells.point(block));
  for (const int block : weight_blocks_) blocks.push_back(cells.log_weight(block));
  for (int d = 0; d < 2; ++d) {
    if (knots_[d]) blocks.push_back(cells.log_gaps(d));
  }
  return blocks;
}

bool TermCost::SeesFree(const std::vector<bool>& fixed) const {
  const auto is_free = [&](int block) { return !fixed[static_cast<size_t>(block)]; };
  return knots_[0] || knots_[1] || std::ranges::any_of(point_blocks_, is_free) ||
         std::ranges::any_of(weight_blocks_, is_free);
}

std::vector<double> TermCost::Values() const {
  const TensorShape& shape = cells_.shape();
  std::vector<double> values;
  for (const int k : points_)
    for (const double x : shape.net.col(k)) values.push_back(unit_ * x);
  for (const int k : weights_) values.push_back(shape.weights[k]);
  if (term_->needs_knots()) {
    const auto append = [&](const SplineBasis& basis) {
      values.insert(values.end(), basis.knots().begin(), basis.knots().end());
    };
    append(shape.basis_u);
    if (shape.basis_v) append(*shape.basis_v);
  }
  return values;
}

bool TermCost::Evaluate(const double* const*, double* residuals, double** jacobians) const {
  const std::vector<double> values = Values();
  const auto rows = static_cast<size_t>(term_->residuals());
  const std::span<double> residual(residuals, rows);
  std::vector<double> whole(jacobians == nullptr ? 0 : rows * values.size(), 0.0);
  if (!term_->Evaluate(values, residual, whole)) return false;
  // Lengths count in the cells' unit: residuals are divided by it, and what they are derived by,
  // where it is not a length, stays.
  for (double& r : residual) r /= unit_;
  if (jacobians == nullptr) return true;
  const size_t lengths = static_cast<size_t>(cells_.dimension()) * points_.size();
  for (size_t k = 0; k < whole.size(); ++k) {
    if (k % values.size() >= lengths) whole[k] /= unit_;
  }
  const Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> J(
      whole.data(), static_cast<Eigen::Index>(rows), static_cast<Eigen::Index>(values.size()));
  using Target = Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>;
  const int dim = cells_.dimension();
  size_t next = 0;
  for (const int block : point_blocks_) {
    if (double* out = jacobians[next++]) {
      Target target(out, J.rows(), dim);
      target.setZero();
      for (size_t k = 0; k < points_.size(); ++k) {
        if (cells_.BlockOf(points_[k]) == block)
          target += J.middleCols(dim * static_cast<Eigen::Index>(k), dim);
      }
    }
  }
  Eigen::Index column = dim * static_cast<Eigen::Index>(points_.size());
  for (const int block : weight_blocks_) {
    if (double* out = jacobians[next++]) {
      Target target(out, J.rows(), 1);
      target.setZero();
      for (size_t k = 0; k < weights_.size(); ++k) {
        if (cells_.BlockOf(weights_[k]) == block) {
          target +=
              cells_.shape().weights[weights_[k]] * J.col(column + static_cast<Eigen::Index>(k));
        }
      }
    }
  }
  column += static_cast<Eigen::Index>(weights_.size());
  for (int d = 0; d < 2; ++d) {
    if (!knots_[d]) continue;
    const auto count = static_cast<Eigen::Index>(
        (d == 0 ? cells_.shape().basis_u : *cells_.shape().basis_v).knots().size());
    const Eigen::Index begin =
        d == 0 ? column : column + static_cast<Eigen::Index>(cells_.shape().basis_u.knots().size());
    if (double* out = jacobians[next++]) {
      Target target(out, J.rows(), cells_.gaps(d));
      target = J.middleCols(begin, count) * cells_.KnotChain(d);
    }
  }
  return true;
}

}  // namespace batten::internal
