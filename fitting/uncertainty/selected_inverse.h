// SPDX-License-Identifier: MIT
// Entries of the inverse of a sparse matrix, where its Cholesky factor has entries.
#pragma once

#include <Eigen/SparseCore>
#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

namespace batten::internal {

// A sparse row vector: indices, all different, with values.
using SparseRow = std::vector<std::pair<int, double>>;

// Entries by index, those of one index added.
inline SparseRow Merged(SparseRow row) {
  std::sort(row.begin(), row.end());
  size_t kept = 0;
  for (size_t k = 1; k < row.size(); ++k) {
    if (row[k].first == row[kept].first) {
      row[kept].second += row[k].second;
    } else {
      row[++kept] = row[k];
    }
  }
  row.resize(row.empty() ? 0 : kept + 1);
  return row;
}

// Of a symmetric positive definite matrix M. O(f) with f the operations of its factorization, and
// no more memory than the factor. [Takahashi, Fagan & Chen 1973; Erisman & Tinney 1975]
class SelectedInverse {
 public:
  // `matrix` holds both triangles. Throws std::invalid_argument unless it is positive definite.
  explicit SelectedInverse(const Eigen::SparseMatrix<double>& matrix);
  ~SelectedInverse();
  SelectedInverse(SelectedInverse&&) noexcept;
  SelectedInverse& operator=(SelectedInverse&&) noexcept;

  // rᵀ M⁻¹ r of a row whose indices all meet in the matrix: M has an entry for each pair.
  double Form(const SparseRow& row) const;

  // M⁻¹ rhs.
  Eigen::MatrixXd Solve(const Eigen::MatrixXd& rhs) const;

 private:
  struct Factor;
  double Entry(int i, int j) const;
  void Fill();

  std::unique_ptr<Factor> factor_;
  std::vector<int> starts_, rows_, place_;  // columns of L; the place of each index in its order
  std::vector<double> inverse_;             // at the places of L's entries
};

}  // namespace batten::internal
