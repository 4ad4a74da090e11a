// SPDX-License-Identifier: MIT
// Real polynomials in Bernstein form on [0, 1]²: what their coefficients tell about their
// least value. Internal to the search for closest points; the coefficient (k, l) of bidegree (m, n)
// is f[k·(n+1) + l]. [Farouki & Rajan 1987]
#pragma once

#include <vector>

namespace batten::internal {

// How many numbers past the coefficients may be read (and not used): memory must reach so far.
inline constexpr int kReadPast = 16;

// Binomial coefficients C(n, 0 … n), n ≤ 2·kMaxDegree.
const std::vector<double>& Binomials(int n);

// Value, gradient and Hessian at one place.
struct PolynomialJet {
  double value, gx, gy, hxx, hxy, hyy;
};
PolynomialJet EvaluateBernstein(const double* f, int m, int n, double x, double y);

double LeastCoefficient(const double* f, int count);

// What differences of the coefficients prove. A difference that vanishes proves both signs.
struct PolynomialBounds {
  bool rises_x, falls_x, rises_y, falls_y;  // monotone, not necessarily strictly
  double lowest;                            // no second derivative in any direction is below this
  double bend_x, bend_y;                    // greatest second differences, scaled by the degrees
};
PolynomialBounds BoundsOf(const double* f, int m, int n);

// De Casteljau at 1/2 in the first or the second variable, for coefficients of `lanes` values each;
// `lower` may be f itself.
void HalveFirst(const double* f, int m, int n, int lanes, double* lower, double* upper);
void HalveSecond(const double* f, int m, int n, int lanes, double* lower, double* upper);

// Adds factor·a·b, of bidegree (2m, 2n), for two polynomials of bidegree (m, n).
void AddProduct(const double* a, const double* b, int m, int n, double factor, double* product);

}  // namespace batten::internal
