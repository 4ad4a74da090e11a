// SPDX-License-Identifier: MIT
#include "fitting/least_squares/fairness.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <vector>

#include "fitting/linear/coefficient_order.h"
#include "geometry/numeric/dense_solvers.h"

namespace batten::internal {
namespace {

// An entry of the symmetric band B.
double BandEntry(const Eigen::MatrixXd& band, int i, int j) {
  const int low = std::min(i, j), a = std::abs(i - j);
  return a < band.cols() ? band(low, a) : 0.0;
}

}  // namespace

Quadrature::Quadrature(int count) {
  Eigen::MatrixXd jacobi = Eigen::MatrixXd::Zero(count, count);
  for (int k = 1; k < count; ++k) {
    jacobi(k, k - 1) = jacobi(k - 1, k) = k / std::sqrt(4.0 * k * k - 1);
  }
  const SymmetricEigen eigen = EigenOf(jacobi);
  nodes = eigen.values;
  weights = 2 * eigen.vectors.row(0).array().square().transpose();
}

Eigen::MatrixXd DerivativeGram(const SplineBasis& basis, int order) {
  const int p = basis.degree();
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(basis.size(), p + 1);
  const Quadrature quadrature(p + 1);
  std::vector<double> values((order + 1) * (p + 1));
  for (const int span : basis.Spans()) {
    const double a = basis.knots()[span], b = basis.knots()[span + 1];
    for (int g = 0; g <= p; ++g) {
      basis.Derivatives(
          span, (a + b) / 2 + (b - a) / 2 * quadrature.nodes[g], order, values.data());
      const double* N = values.data() + order * (p + 1);
      const double weight = quadrature.weights[g] * (b - a) / 2;
      for (int r = 0; r <= p; ++r) {
        for (int s = r; s <= p; ++s) gram(span - p + r, s - r) += weight * N[r] * N[s];
      }
    }
  }
  return gram;
}

FairnessForm::FairnessForm(const SplineBasis& outer,
                           const SplineBasis* inner,
                           FairnessEnergy energy)
    : outer_rows_(CoefficientOrder(outer).Rows(outer)), inner_rows_(DistinctIndices(inner)) {
  for (const EnergyTerm& term : EnergyTerms(energy, outer.degree(), inner ? inner->degree() : 0)) {
    terms_.push_back({term.factor,
                      DerivativeGram(outer, term.outer),
                      inner ? DerivativeGram(*inner, term.inner) : Eigen::MatrixXd::Ones(1, 1)});
  }
}

void FairnessForm::AddTo(BlockBandedMatrix& matrix, double weight) const {
  const auto outer_size = static_cast<int>(outer_rows_.size()),
             inner_size = static_cast<int>(inner_rows_.size());
  for (const Term& term : terms_) {
    const int reach = static_cast<int>(term.inner.cols()) - 1;
    for (int k = 0; k < outer_size; ++k) {
      for (int below = 0; below < term.outer.cols() && below <= k; ++below) {
        const int row = outer_rows_[static_cast<size_t>(k)],
                  row2 = outer_rows_[static_cast<size_t>(k - below)];
        // Two functions of one coefficient meet on the diagonal, from either side.
        const double times = row == row2 && below > 0 ? 2 : 1;
        const double c = times * weight * term.factor * term.outer(k - below, below);
        auto block = matrix.at(std::max(row, row2), std::abs(row2 - row));
        for (int j = 0; j < inner_size; ++j) {
          const int column = inner_rows_[static_cast<size_t>(j)];
          block(column, column) += c * term.inner(j, 0);
          for (int a = 1; a <= reach && j + a < inner_size; ++a) {
            const int column2 = inner_rows_[static_cast<size_t>(j + a)];
            block(column2, column) += c * term.inner(j, a);
            block(column, column2) += c * term.inner(j, a);
          }
        }
      }
    }
  }
}

void FairnessForm::AddTo(TensorBand& band, double weight) const {
  for (const Term& term : terms_) {
    for (int i = 0; i < band.outer_size(); ++i) {
      for (int a = 0; a < term.outer.cols() && i + a < band.outer_size(); ++a) {
        const double c = weight * term.factor * term.outer(i, a);
        double* to = band.row(i, a);
        for (int j = 0; j < band.inner_size(); ++j) {
          for (int b = 0; b < term.inner.cols() && j + b < band.inner_size(); ++b)
            to[j * term.inner.cols() + b] += c * term.inner(j, b);
        }
      }
    }
  }
}

double FairnessForm::Trace() const {
  double trace = 0;
  for (const Term& term : terms_) {
    trace += term.factor * term.outer.col(0).sum() * term.inner.col(0).sum();
  }
  return trace;
}

double FairnessForm::Energy(const Eigen::VectorXd& coefficients) const {
  const int outer_size = static_cast<int>(terms_[0].outer.rows());
  const int inner_size = static_cast<int>(terms_[0].inner.rows());
  const Eigen::Map<const Eigen::MatrixXd> net(coefficients.data(), inner_size, outer_size);
  double energy = 0;
  for (const Term& term : terms_) {
    Eigen::MatrixXd inner_applied = Eigen::MatrixXd::Zero(inner_size, outer_size);
    const int q = static_cast<int>(term.inner.cols()) - 1;
    for (int i = 0; i < inner_size; ++i) {
      for (int j = std::max(0, i - q); j <= std::min(inner_size - 1, i + q); ++j) {
        inner_applied.row(i) += BandEntry(term.inner, i, j) * net.row(j);
      }
    }
    const int p = static_cast<int>(term.outer.cols()) - 1;
    for (int i = 0; i < outer_size; ++i) {
      for (int j = std::max(0, i - p); j <= std::min(outer_size - 1, i + p); ++j) {
        energy += term.factor * BandEntry(term.outer, i, j) * net.col(i).dot(inner_applied.col(j));
      }
    }
  }
  return energy;
}

}  // namespace batten::internal
