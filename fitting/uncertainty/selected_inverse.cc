// SPDX-License-Identifier: MIT
#include "fitting/uncertainty/selected_inverse.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <stdexcept>

namespace batten::internal {

struct SelectedInverse::Factor {
  Eigen::SimplicialLLT<Eigen::SparseMatrix<double>, Eigen::Lower, Eigen::AMDOrdering<int>> llt;
};

SelectedInverse::SelectedInverse(const Eigen::SparseMatrix<double>& matrix)
    : factor_(std::make_unique<Factor>()) {
  factor_->llt.compute(matrix);
  if (factor_->llt.info() != Eigen::Success) {
    throw std::invalid_argument("SelectedInverse: matrix: is not positive definite");
  }
  const Eigen::SparseMatrix<double> lower = factor_->llt.matrixL();
  starts_.assign(lower.outerIndexPtr(), lower.outerIndexPtr() + lower.cols() + 1);
  rows_.assign(lower.innerIndexPtr(), lower.innerIndexPtr() + lower.nonZeros());
  inverse_.assign(lower.valuePtr(), lower.valuePtr() + lower.nonZeros());
  const auto& order = factor_->llt.permutationP().indices();
  place_.assign(order.data(), order.data() + order.size());
  Fill();
}

SelectedInverse::~SelectedInverse() = default;
SelectedInverse::SelectedInverse(SelectedInverse&&) noexcept = default;
SelectedInverse& SelectedInverse::operator=(SelectedInverse&&) noexcept = default;

// Overwrites L by Z = M⁻¹, last column first: with l = L_·j / L_jj below the diagonal,
//   Z_ij = −Σ_k Z_ik l_k,   Z_jj = 1 / L_jj² − Σ_k l_k Z_kj,
// k over the rows of column j, whose entries Z_ik lie in columns that are done.
void SelectedInverse::Fill() {
  const auto n = static_cast<int>(place_.size());
  std::vector<int> at(place_.size(), -1);
  std::vector<double> l, z;
  for (int j = n - 1; j >= 0; --j) {
    const int first = starts_[j] + 1, count = starts_[j + 1] - first;
    const double diagonal = inverse_[first - 1];
    l.assign(inverse_.begin() + first, inverse_.begin() + first + count);
    for (double& value : l) value /= diagonal;
    z.assign(static_cast<size_t>(count), 0);
    for (int k = 0; k < count; ++k) at[rows_[first + k]] = k;
    for (int k = 0; k < count; ++k) {
      const int column = rows_[first + k];
      z[k] -= inverse_[starts_[column]] * l[k];
      for (int e = starts_[column] + 1; e < starts_[column + 1]; ++e) {
        const int i = at[rows_[e]];
        if (i < 0) continue;
        z[i] -= inverse_[e] * l[k];
        z[k] -= inverse_[e] * l[i];
      }
    }
    double own = 1 / (diagonal * diagonal);
    for (int k = 0; k < count; ++k) {
      at[rows_[first + k]] = -1;
      inverse_[first + k] = z[k];
      own -= l[k] * z[k];
    }
    inverse_[first - 1] = own;
  }
}

double SelectedInverse::Entry(int i, int j) const {
  const int row = std::max(place_[i], place_[j]), column = std::min(place_[i], place_[j]);
  const auto begin = rows_.begin() + starts_[column], end = rows_.begin() + starts_[column + 1];
  const auto found = std::lower_bound(begin, end, row);
  return found != end && *found == row ? inverse_[static_cast<size_t>(found - rows_.begin())] : 0;
}

double SelectedInverse::Form(const SparseRow& row) const {
  double sum = 0;
  for (size_t a = 0; a < row.size(); ++a) {
    sum += row[a].second * row[a].second * Entry(row[a].first, row[a].first);
    for (size_t b = 0; b < a; ++b)
      sum += 2 * row[a].second * row[b].second * Entry(row[a].first, row[b].first);
  }
  return sum;
}

Eigen::MatrixXd SelectedInverse::Solve(const Eigen::MatrixXd& rhs) const {
  return factor_->llt.solve(rhs);
}

}  // namespace batten::internal
