// SPDX-License-Identifier: MIT
#include "fitting/least_squares/fairness.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <vector>

#include "geometry/numeric/gauss_rule.h"

namespace batten::internal {
namespace {

// An entry of the symmetric band B.
double BandEntry(const Eigen::MatrixXd& band, int i, int j) {
  const int low = std::min(i, j), a = std::abs(i - j);
  return a < band.cols() ? band(low, a) : 0.0;
}

}  // namespace

Eigen::MatrixXd DerivativeGram(const SplineBasis& basis, int order) {
  const int p = basis.degree();
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(basis.size(), p + 1);
  const GaussRule rule = GaussLegendre(p + 1);
  std::vector<double> values((order + 1) * (p + 1));
  for (const int span : basis.Spans()) {
    const double a = basis.knots()[span], b = basis.knots()[span + 1];
    for (int g = 0; g <= p; ++g) {
      basis.Derivatives(span, a + (b - a) * rule.nodes[g], order, values.data());
      const double* N = values.data() + order * (p + 1);
      const double weight = rule.weights[g] * (b - a);
      for (int r = 0; r <= p; ++r) {
        for (int s = r; s <= p; ++s) gram(span - p + r, s - r) += weight * N[r] * N[s];
      }
    }
  }
  return gram;
}

FairnessForm::FairnessForm(const SplineBasis& outer,
                           const SplineBasis* inner,
                           FairnessEnergy energy) {
  for (const EnergyTerm& term : EnergyTerms(energy, outer.degree(), inner ? inner->degree() : 0)) {
    terms_.push_back({term.factor,
                      DerivativeGram(outer, term.outer),
                      inner ? DerivativeGram(*inner, term.inner) : Eigen::MatrixXd::Ones(1, 1)});
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
