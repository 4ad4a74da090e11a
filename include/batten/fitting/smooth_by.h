// SPDX-License-Identifier: MIT
// Where the weight of fairness comes from.
#pragma once

namespace batten {

enum class SmoothBy {
  kWeight,           // the options' `smoothing`
  kCrossValidation,  // generalised cross-validation; see choose_smoothing.h
  kNoise,            // so that the residuals are as large as the noise
};

}  // namespace batten
