// SPDX-License-Identifier: MIT
// Fairness energies of tensor-product splines, integrated exactly.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "batten/fitting/fairness_energy.h"
#include "batten/geometry/spline_basis.h"
#include "fitting/linear/block_banded_matrix.h"
#include "fitting/linear/tensor_band.h"

namespace batten::internal {

// Gauss–Legendre nodes and weights on [-1, 1], exact for polynomials of degree 2·count − 1.
// [Golub & Welsch 1969]
struct Quadrature {
  explicit Quadrature(int count);
  Eigen::VectorXd nodes, weights;
};

// The banded Gram matrix of k-th derivatives: row i, column a holds ∫ N_i^(k) N_{i+a}^(k) over the
// domain, a = 0 … p. Gauss–Legendre quadrature with p+1 nodes a span, which is exact.
Eigen::MatrixXd DerivativeGram(const SplineBasis& basis, int order);

// A fairness energy as a quadratic form in the coefficients, integrated exactly on the knot spans;
// a curve has no inner basis (null). Where a degree is below the energy's order, the highest order
// both degrees carry is used. Parameters should be lengths, so that both directions weigh the same.
class FairnessForm {
 public:
  FairnessForm(const SplineBasis& outer,
               const SplineBasis* inner,
               FairnessEnergy energy = FairnessEnergy::kThinPlate);

  // Adds weight times the form to a matrix of EmptyMatrix' sizes and order of rows.
  void AddTo(BlockBandedMatrix& matrix, double weight) const;

  // The same for open bases, coefficient by coefficient.
  void AddTo(TensorBand& band, double weight) const;

  double Trace() const;

  // cᵀ P c of one coefficient vector, repeated ones included; (i,j) is i·inner.size() + j.
  double Energy(const Eigen::VectorXd& coefficients) const;

 private:
  struct Term {
    double factor;
    Eigen::MatrixXd outer, inner;
  };
  std::vector<Term> terms_;
  std::vector<int> outer_rows_, inner_rows_;  // in the matrix
};

}  // namespace batten::internal
