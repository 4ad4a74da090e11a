// SPDX-License-Identifier: MIT
// Ends of a flattened tube as periodic curves.
#pragma once

#include <Eigen/Core>

#include "batten/fitting/point_mask.h"

namespace batten::internal {

// A Fourier series round a tube: c0 + Σ c_k cos(2πku/P) + d_k sin(2πku/P).
class PeriodicWave {
 public:
  static constexpr int kMostHarmonics = 6;
  using Terms = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 2 * kMostHarmonics + 1, 1>;

  PeriodicWave(double period, int harmonics);
  // Its terms at u: 1, cos, sin, cos 2, sin 2, …
  Terms TermsAt(double u) const;
  double At(double u) const;
  Eigen::VectorXd coefficients;

 private:
  double period_;
};

// Smooth curves below and above the places (u round, v along) under the mask, as close to the
// outermost places as these are to each other; where the edge of the cloud is ragged, or has a gap,
// they pass through most of it. `spacing` is that of the places. O(m).
struct TubeEnds {
  PeriodicWave low, high;
};
TubeEnds EndsOf(const Eigen::Matrix2Xd& places,
                const PointMask& mask,
                double period,
                double spacing);

}  // namespace batten::internal
