// SPDX-License-Identifier: MIT
// The mean profile of a surface of revolution, and places along it.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "batten/geometry/spline_basis.h"
#include "batten/geometry/thread_pool.h"

namespace batten::internal {

// A smooth plane curve (r, z) over [0, range()], open or closed, of uniform cubic spans; C².
class BaseProfile {
 public:
  // The spline of least squares through places (2 × n) at parameters of [0, range], on which a
  // closed one is periodic. `weights` may be empty. O(n).
  BaseProfile(const Eigen::Matrix2Xd& places,
              const Eigen::VectorXd& parameters,
              const Eigen::VectorXd& weights,
              double range,
              int spans,
              bool closed,
              ThreadPool& pool);

  double range() const { return range_; }
  bool closed() const { return closed_; }
  double speed() const { return speed_; }  // length over range: the mean of |C'|

  struct Jet {
    Eigen::Vector2d place, first, second;
  };
  Jet At(double s) const;

  // Parameter of the nearest place: the best of samples, from there by Newton's steps.
  double Foot(const Eigen::Vector2d& place) const;

  // Length of the curve from 0 to s: as smooth as the curve.
  double Length(double s) const;

 private:
  int SpanOf(double s) const;

  double range_, width_;  // of a span
  bool closed_;
  double speed_ = 1;
  std::vector<Eigen::Matrix<double, 2, 4>> spans_;  // powers of s − start
  std::vector<double> lengths_;                     // at the spans' starts, and the end
  Eigen::MatrixX2d samples_;                        // filled up with infinite ones
  double sample_step_ = 0;
};

}  // namespace batten::internal
