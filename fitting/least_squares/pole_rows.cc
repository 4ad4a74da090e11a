// SPDX-License-Identifier: MIT
#include "fitting/least_squares/pole_rows.h"

#include <Eigen/Core>
#include <vector>

#include "fitting/linear/coefficient_order.h"

namespace batten::internal {

NetTies PoleTies(const SplineBasis& basis_u,
                 const SplineBasis& basis_v,
                 const Poles& poles,
                 bool u_outside) {
  NetTies ties;
  if (!poles.any()) return ties;
  const PoleFreedom freedom = FreeVariablesOf(basis_u, basis_v, poles);
  const SplineBasis& outer = u_outside ? basis_u : basis_v;
  const std::vector<int> outer_rows = CoefficientOrder(outer).Rows(outer);
  const int m = DistinctCount(basis_u), size_v = DistinctCount(basis_v);
  int begin = 0, end = size_v;  // of the rows v that are free
  ties.forms = Eigen::MatrixXd::Zero(std::ssize(freedom.rows) * m, freedom.unknowns);
  for (const TiedRow& row : freedom.rows) {
    if (row.j == begin) {
      ++begin;
    } else {
      --end;
    }
    for (int i = 0; i < m; ++i) {
      const auto at = [&](int k) { return outer_rows[static_cast<size_t>(k)]; };
      ties.forms.block(std::ssize(ties.tied), row.first, 1, row.form.cols()) = row.form.row(i);
      ties.tied.push_back(u_outside ? Eigen::Index{at(i)} * size_v + row.j
                                    : Eigen::Index{at(row.j)} * m + i);
    }
  }
  ties.first_block = u_outside ? 0 : begin;
  ties.blocks = u_outside ? m : end - begin;
  ties.first_row = u_outside ? begin : 0;
  ties.rows = u_outside ? end - begin : m;
  return ties;
}

}  // namespace batten::internal
