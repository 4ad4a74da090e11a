// SPDX-License-Identifier: MIT
#include "fitting/least_squares/nested_bases.h"

#include <vector>

namespace batten::internal {
namespace {

// A2.2 with another parameter in each step: values[r] of function span − p + r.
void DiscreteValues(const SplineBasis& coarse,
                    int span,
                    const double* parameters,
                    std::vector<double>& values) {
  const std::vector<double>& t = coarse.knots();
  values[0] = 1;
  for (int k = 1; k <= coarse.degree(); ++k) {
    const double x = parameters[k];
    double saved = 0;
    for (int r = 0; r < k; ++r) {
      const double above = t[span + r + 1], below = t[span + 1 - k + r];
      const double share = values[r] / (above - below);
      values[r] = saved + (above - x) * share;
      saved = (x - below) * share;
    }
    values[k] = saved;
  }
}

}  // namespace

Eigen::SparseMatrix<double, Eigen::RowMajor> KnotInsertion(const SplineBasis& coarse,
                                                           const SplineBasis& fine) {
  const int p = coarse.degree();
  Eigen::SparseMatrix<double, Eigen::RowMajor> matrix(fine.size(), coarse.size());
  matrix.reserve(Eigen::VectorXi::Constant(fine.size(), p + 1));
  std::vector<double> values(static_cast<std::size_t>(p) + 1);
  for (int i = 0; i < fine.size(); ++i) {
    const double* from = fine.knots().data() + i;
    const int span = coarse.Span(*from);
    DiscreteValues(coarse, span, from, values);
    for (int r = 0; r <= p; ++r) matrix.insert(i, span - p + r) = values[r];
  }
  matrix.makeCompressed();
  return matrix;
}

SplineBasis EveryKnot(const SplineBasis& fine, int step) {
  const std::vector<double>& knots = fine.knots();
  std::vector<double> breaks{fine.lower()};
  for (int k = fine.degree() + step; k < fine.size(); k += step)
    breaks.push_back(knots[static_cast<std::size_t>(k)]);
  breaks.push_back(fine.upper());
  return SplineBasis::Clamped(fine.degree(), breaks);
}

}  // namespace batten::internal
