// SPDX-License-Identifier: MIT
#include "fitting/linear/tied_system.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace batten::internal {

TiedSystem::TiedSystem(BlockBandedMatrix matrix, const NetTies& ties)
    : ties_(ties), block_size_(matrix.block_size()) {
  if (!ties_.any()) {
    inner_ = std::move(matrix);
    return;
  }
  if (ties_.blocks > 0 && ties_.rows > 0) GatherFree(matrix);
  GatherOutline(matrix);
}

// The index among the free rows; −1: tied.
Eigen::Index TiedSystem::FreeRow(Eigen::Index block, Eigen::Index row) const {
  block -= ties_.first_block;
  row -= ties_.first_row;
  const bool free = block >= 0 && block < ties_.blocks && row >= 0 && row < ties_.rows;
  return free ? block * ties_.rows + row : -1;
}

void TiedSystem::GatherFree(const BlockBandedMatrix& matrix) {
  const int bandwidth = std::min(matrix.bandwidth(), ties_.blocks - 1);
  inner_.emplace(ties_.blocks, ties_.rows, bandwidth);
  for (int k = 0; k < ties_.blocks; ++k) {
    for (int below = 0; below <= std::min(bandwidth, k); ++below) {
      inner_->at(k, below) = matrix.at(k + ties_.first_block, below)
                                 .block(ties_.first_row, ties_.first_row, ties_.rows, ties_.rows);
    }
  }
}

// Multiplies the tied columns of M by the forms: the free rows give the border, the tied rows,
// multiplied by the forms once more, the corner.
void TiedSystem::GatherOutline(const BlockBandedMatrix& matrix) {
  const Eigen::Index b = block_size_, unknowns = ties_.forms.cols();
  std::vector<Eigen::Index> place(static_cast<size_t>(matrix.size()), -1);
  for (size_t k = 0; k < ties_.tied.size(); ++k)
    place[static_cast<size_t>(ties_.tied[k])] = static_cast<Eigen::Index>(k);
  // Unknowns in a row of their own, so that one entry touches neighbours only.
  Eigen::MatrixXd border = Eigen::MatrixXd::Zero(unknowns, inner_ ? inner_->size() : 0);
  const Eigen::MatrixXd forms = ties_.forms.transpose();
  Eigen::MatrixXd products = Eigen::MatrixXd::Zero(unknowns, forms.cols());
  for (size_t t = 0; t < ties_.tied.size(); ++t) {
    const auto form = forms.col(static_cast<Eigen::Index>(t));
    const auto block = static_cast<int>(ties_.tied[t] / b);
    const Eigen::Index column = ties_.tied[t] % b;
    const int last = std::min(matrix.blocks() - 1, block + matrix.bandwidth());
    for (int other = std::max(0, block - matrix.bandwidth()); other <= last; ++other) {
      const auto entries = matrix.at(std::max(block, other), std::abs(block - other));
      for (Eigen::Index row = 0; row < b; ++row) {
        const double entry = other >= block ? entries(row, column) : entries(column, row);
        if (entry == 0) continue;
        const Eigen::Index free = FreeRow(other, row);
        if (free >= 0) {
          border.col(free) += entry * form;
        } else {
          products.col(place[static_cast<size_t>(other * b + row)]) += entry * form;
        }
      }
    }
  }
  border_ = border.transpose();
  corner_.noalias() = products * ties_.forms;
}

Eigen::MatrixXd TiedSystem::Free(const Eigen::MatrixXd& rows) const {
  Eigen::MatrixXd free(Eigen::Index{ties_.blocks} * ties_.rows, rows.cols());
  for (Eigen::Index k = 0; k < ties_.blocks; ++k) {
    free.middleRows(k * ties_.rows, ties_.rows) =
        rows.middleRows((k + ties_.first_block) * block_size_ + ties_.first_row, ties_.rows);
  }
  return free;
}

Eigen::MatrixXd TiedSystem::Tied(const Eigen::MatrixXd& rows) const {
  return ties_.forms.transpose() * rows(ties_.tied, Eigen::all);
}

bool TiedSystem::Factor(ThreadPool* pool) {
  if (inner_ && !inner_->Factor(pool)) return false;
  if (!ties_.any()) return true;
  if (inner_) {
    inner_->Forward(border_);
    corner_.noalias() -= border_.transpose() * border_;
  }
  corner_factor_.emplace(corner_);
  return corner_factor_->info() == Eigen::Success;
}

double TiedSystem::SmallestPivot() const {
  double least = std::numeric_limits<double>::infinity();
  if (inner_) least = inner_->SmallestPivot();
  if (ties_.any())
    least = std::min(least, corner_factor_->matrixLLT().diagonal().cwiseAbs2().minCoeff());
  return least;
}

void TiedSystem::Solve(Eigen::MatrixXd& rhs) const {
  if (!ties_.any()) {
    inner_->Solve(rhs);
    return;
  }
  Eigen::MatrixXd unknowns = Tied(rhs);
  Eigen::MatrixXd free = Free(rhs);
  if (inner_) {
    inner_->Forward(free);
    unknowns.noalias() -= border_.transpose() * free;
  }
  corner_factor_->solveInPlace(unknowns);
  rhs(ties_.tied, Eigen::all) = ties_.forms * unknowns;
  if (!inner_) return;
  free.noalias() -= border_ * unknowns;
  inner_->Backward(free);
  for (Eigen::Index k = 0; k < ties_.blocks; ++k) {
    rhs.middleRows((k + ties_.first_block) * block_size_ + ties_.first_row, ties_.rows) =
        free.middleRows(k * ties_.rows, ties_.rows);
  }
}

}  // namespace batten::internal
