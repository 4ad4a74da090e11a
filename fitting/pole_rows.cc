// SPDX-License-Identifier: MIT
#include "batten/fitting/pole_rows.h"

#include <Eigen/Cholesky>
#include <Eigen/SparseCore>
#include <vector>

#include "batten/fitting/coefficient_order.h"

namespace batten {

Eigen::MatrixXd PoleConditionsOnRows(const SplineBasis& basis_u,
                                     const SplineBasis& basis_v,
                                     const Poles& poles,
                                     bool u_outside) {
  if (!poles.any()) return Eigen::MatrixXd(0, 0);
  const Eigen::MatrixXd on_net = PoleConditions(basis_u, basis_v, poles);
  const SplineBasis& outer = u_outside ? basis_u : basis_v;
  const std::vector<int> outer_rows = CoefficientOrder(outer).Rows(outer);
  const int size_v = DistinctCount(basis_v);
  const int inner = DistinctCount(u_outside ? basis_v : basis_u);
  Eigen::MatrixXd on_rows(on_net.rows(), on_net.cols());
  for (Eigen::Index k = 0; k < on_net.cols(); ++k) {
    const Eigen::Index i = k / size_v, j = k % size_v;
    const int row = outer_rows[static_cast<size_t>(u_outside ? i : j)];
    on_rows.col(Eigen::Index{row} * inner + (u_outside ? j : i)) = on_net.col(k);
  }
  return on_rows;
}

void MeetConditions(const BlockBandedMatrix& factor,
                    const Eigen::MatrixXd& conditions,
                    Eigen::MatrixXd& rows) {
  if (conditions.rows() == 0) return;
  Eigen::MatrixXd reach = conditions.transpose();
  factor.Solve(reach);
  // A condition is on one or two rows of the net.
  const Eigen::SparseMatrix<double, Eigen::RowMajor> sparse = conditions.sparseView();
  const Eigen::LDLT<Eigen::MatrixXd> middle(sparse * reach);
  // Twice for the sake of rounding.
  for (int pass = 0; pass < 2; ++pass) rows -= reach * middle.solve(sparse * rows);
}

}  // namespace batten
