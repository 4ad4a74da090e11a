// SPDX-License-Identifier: MIT
#include "geometry/construction/spline_interpolation.h"

#include <Eigen/SparseLU>
#include <string>
#include <vector>

#include "geometry/numeric/construction_checks.h"

namespace batten::internal {
namespace {

using Matrix = Eigen::SparseMatrix<double>;

int SpanOf(const SplineBasis& basis, const SplineDatum& datum) {
  int span = basis.Span(datum.at);
  while (datum.from_left && span > basis.degree() && basis.knots()[span] >= datum.at) --span;
  return span;
}

// Row k holds the functions of the basis at datum k; those of a period later count as the first.
Matrix CollocationMatrix(const SplineBasis& basis, std::span<const SplineDatum> data) {
  const int p = basis.degree(), unknowns = static_cast<int>(data.size());
  std::vector<Eigen::Triplet<double>> entries;
  std::vector<double> values;
  for (int row = 0; row < unknowns; ++row) {
    const SplineDatum& datum = data[row];
    const int span = SpanOf(basis, datum);
    values.resize((datum.order + 1) * (p + 1));
    basis.Derivatives(span, datum.at, datum.order, values.data());
    for (int r = 0; r <= p; ++r) {
      const double value = values[datum.order * (p + 1) + r];
      if (value != 0) entries.emplace_back(row, (span - p + r) % unknowns, value);
    }
  }
  Matrix matrix(unknowns, unknowns);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

}  // namespace

Eigen::MatrixXd Interpolated(const SplineBasis& basis,
                             std::span<const SplineDatum> data,
                             const Eigen::MatrixXd& values) {
  const Eigen::Index unknowns = basis.size() - (basis.periodic() ? basis.degree() : 0);
  RequireThat(static_cast<Eigen::Index>(data.size()) == unknowns && values.cols() == unknowns,
              "Interpolated",
              std::to_string(data.size()) + " data do not determine " + std::to_string(unknowns) +
                  " coefficients");
  Eigen::VectorXd middle = Eigen::VectorXd::Zero(values.rows());
  Eigen::Index places = 0;
  for (Eigen::Index k = 0; k < unknowns; ++k) {
    if (data[k].order > 0) continue;
    ++places;
    middle += (values.col(k) - middle) / static_cast<double>(places);
  }
  Eigen::MatrixXd right = values.transpose();
  for (Eigen::Index k = 0; k < unknowns; ++k) {
    if (data[k].order == 0) right.row(k) -= middle.transpose();
  }
  Eigen::SparseLU<Matrix> factors(CollocationMatrix(basis, data));
  RequireThat(factors.info() == Eigen::Success,
              "Interpolated",
              "the data leave the spline undetermined: a span of its knots holds none of them");
  const Eigen::MatrixXd free = factors.solve(right);
  Eigen::MatrixXd coefficients(values.rows(), basis.size());
  for (int i = 0; i < basis.size(); ++i) {
    coefficients.col(i) = free.row(i % unknowns).transpose() + middle;
  }
  return coefficients;
}

}  // namespace batten::internal
