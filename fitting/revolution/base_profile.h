// SPDX-License-Identifier: MIT
// Mean profile of a surface of revolution as a cubic spline curve.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "batten/geometry/spline_basis.h"
#include "batten/geometry/thread_pool.h"

namespace batten::internal {

// A smooth plane curve (r, z) over [0, range()], open or closed, of uniform cubic spans; C².
class BaseProfile {
 public:
  // Fits the spline by least squares to places (2 × n) at parameters in [0, range]; a closed one is
  // periodic. `weights` may be empty. O(n).
  BaseProfile(const Eigen::Matrix2Xd& places,
              const Eigen::VectorXd& parameters,
              const Eigen::VectorXd& weights,
              double range,
              int spans,
              bool closed,
              ThreadPool& pool);

  double range() const { return range_; }

  struct Jet {
    Eigen::Vector2d place, first, second;
  };
  Jet At(double s) const;

  // Parameter of the foot point of a place: the nearest sample, refined by Newton steps.
  double Foot(const Eigen::Vector2d& place) const;

  // Length of the curve from 0 to s: as smooth as the curve.
  double Length(double s) const;

 private:
  int SpanOf(double s) const;

  double range_, width_;  // of a span
  bool closed_;
  std::vector<Eigen::Matrix<double, 2, 4>> spans_;  // coefficients of powers of s − start
  std::vector<double> lengths_;                     // at the spans' starts, and the end
  Eigen::MatrixX2d samples_;                        // padded with infinite ones
  double sample_step_ = 0;
};

}  // namespace batten::internal
