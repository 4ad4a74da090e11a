// SPDX-License-Identifier: MIT
// Tail probabilities of the F distribution and quantiles of the t distribution.
#pragma once

namespace batten::internal {

// The regularized incomplete beta function I_x(a, b), a, b > 0, x in [0, 1], by its continued
// fraction. [Abramowitz & Stegun 1964, 26.5.8; Lentz 1976]
double IncompleteBeta(double x, double a, double b);

// The probability that F with these degrees of freedom (> 0, need not be whole numbers) exceeds f.
double FTail(double f, double freedoms_above, double freedoms_below);

// The t quantile at 99.73 % divided by 3: the factor by which an interval of three standard
// deviations widens where the standard deviation is estimated with so many degrees of freedom left.
// 78 with one, 1.15 with twenty; infinite with none.
double FewFactor(double freedoms_left);

}  // namespace batten::internal
