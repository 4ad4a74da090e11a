// SPDX-License-Identifier: MIT
// Fairness energies of tensor-product splines, integrated exactly.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "batten/fitting/block_banded_matrix.h"
#include "batten/geometry/spline_basis.h"

namespace batten {

// Gauss–Legendre nodes and weights on [-1, 1], exact for polynomials of degree 2·count − 1.
// [Golub & Welsch 1969]
struct Quadrature {
  explicit Quadrature(int count);
  Eigen::VectorXd nodes, weights;
};

// Row i, column a: ∫ N_i^(k) N_{i+a}^(k) over the domain, a = 0 … p. Gauss–Legendre quadrature with
// p+1 nodes a span, which is exact.
Eigen::MatrixXd DerivativeGram(const SplineBasis& basis, int order);

// The thin-plate energy ∫∫ S_uu² + 2 S_uv² + S_vv² as a quadratic form in the coefficients; where a
// degree is 1, and second derivatives vanish, the membrane energy ∫∫ S_u² + S_v² instead.
// Parameters should be lengths, so that both directions weigh the same. Of a curve, without an
// inner basis (null): ∫ C″², or ∫ C′² at degree 1.
class FairnessForm {
 public:
  FairnessForm(const SplineBasis& outer, const SplineBasis* inner);

  // Adds weight times the form to a matrix of EmptyMatrix' sizes and order of rows.
  void AddTo(BlockBandedMatrix& matrix, double weight) const;

  double Trace() const;

  // cᵀ P c of one coefficient vector, repeated ones included; (i,j) is i·inner.size() + j.
  double Energy(const Eigen::VectorXd& coefficients) const;

 private:
  struct Term {
    double factor;
    Eigen::MatrixXd outer, inner;
  };
  Term terms_[3];
  int term_count_;
  std::vector<int> outer_rows_, inner_rows_;  // in the matrix
};

}  // namespace batten
