// SPDX-License-Identifier: MIT
// Fairness energies of tensor-product splines, integrated exactly.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "batten/fitting/fairness_energy.h"
#include "batten/geometry/spline_basis.h"
#include "fitting/linear/tensor_band.h"

namespace batten::internal {

// Smoothing from which on the fairness energy determines what it can; coefficients still
// undetermined are in its null space.
inline constexpr double kFirmSmoothing = 1e-7;

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

  // Adds weight times the form, coefficient by coefficient, repeated ones apart.
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
};

}  // namespace batten::internal
