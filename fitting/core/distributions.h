// SPDX-License-Identifier: MIT
// Tails of the F and t distributions.
#pragma once

namespace batten::internal {

// The regularized incomplete beta function I_x(a, b), a, b > 0, x in [0, 1], by its continued
// fraction. [Abramowitz & Stegun 1964, 26.5.8; Lentz 1976]
double IncompleteBeta(double x, double a, double b);

// How likely F with these freedoms (> 0, not all whole numbers) is above f.
double FTail(double f, double freedoms_above, double freedoms_below);

// How much wider than three standard deviations an error's interval of the same probability
// (99.73 %) is where the standard deviation is itself estimated with so many freedoms left: t's
// quantile over 3. 78 with one, 1.15 with twenty; infinite with none.
double FewFactor(double freedoms_left);

}  // namespace batten::internal
