// SPDX-License-Identifier: MIT
// Losses that bound the pull of points far from the surface.
#pragma once

#include <Eigen/Core>

namespace batten {

// What a residual r costs at scale s, with t = |r| / (tuning · s).
enum class Loss {
  kNone,       // r²/2
  kHuber,      // linear beyond t = 1; tuning 1.345
  kCauchy,     // log(1 + t²)/2; tuning 2.385
  kTukey,      // constant beyond t = 1: such points do not count at all; tuning 4.685
  kTruncated,  // the plain square up to t = 1, constant beyond; tuning 2.795
};

// Whether points beyond some distance do not count at all.
bool ForgetsFarPoints(Loss loss);

// ρ(r) itself, r²/2 near zero.
double LossValue(Loss loss, double residual, double scale);

// ρ'(r)/r relative to the plain square: the weight of iterative reweighting. The tuning constants
// keep 95 % efficiency on normal noise; of the truncated square, which jumps, the asymptotic
// formula counts its jump too. [Huber 1981; Maronna et al. 2006]
double LossWeight(Loss loss, double residual, double scale);
Eigen::VectorXd LossWeights(Loss loss, const Eigen::VectorXd& residuals, double scale);

// 1.4826 times the median absolute residual: the standard deviation of the bulk.
double RobustScale(const Eigen::VectorXd& residuals);

}  // namespace batten
