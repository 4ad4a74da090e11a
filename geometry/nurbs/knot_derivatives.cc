// SPDX-License-Identifier: MIT
#include "geometry/nurbs/knot_derivatives.h"

namespace batten::internal {

// N is built up degree by degree: at degree k, with a = u_{i+r+1} − u and b = u − u_{i+1−k+r} the
// distances to the two knots between which function r lives, t = N_r/(a + b) gives a·t to function
// r and b·t to function r + 1. D carries the same steps' derivatives; row j stands for knot
// i − p + 1 + j.
KnotDerivativeMatrix KnotDerivatives(const SplineBasis& basis, int span, double u, double* values) {
  const int p = basis.degree();
  const double* U = basis.knots().data() + span;  // U[1 − p] … U[p] are the knots that matter
  KnotDerivativeMatrix D = KnotDerivativeMatrix::Zero(2 * p, p + 1);
  values[0] = 1;
  for (int k = 1; k <= p; ++k) {
    double saved = 0;
    double saved_row[2 * kMaxDegree] = {};
    for (int r = 0; r < k; ++r) {
      const int right = p + r, left = p - k + r;  // rows of the knots U[r + 1] and U[r + 1 − k]
      const double a = U[r + 1] - u, b = u - U[r + 1 - k], width = U[r + 1] - U[r + 1 - k];
      const double t = values[r] / width;
      values[r] = saved + a * t;
      saved = b * t;
      for (int j = p - k; j < p + k; ++j) {
        // Knots other than the outermost two move t only through the lower degree.
        double dt = D(j, r) / width;
        if (j == right) dt -= t / width;
        if (j == left) dt += t / width;
        D(j, r) = saved_row[j] + a * dt + (j == right ? t : 0.0);
        saved_row[j] = b * dt - (j == left ? t : 0.0);
      }
    }
    values[k] = saved;
    for (int j = p - k; j < p + k; ++j) D(j, k) = saved_row[j];
  }
  return D;
}

}  // namespace batten::internal
