// SPDX-License-Identifier: MIT
// Where two curves of space meet, or come nearest.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "batten/geometry/curve_evaluator.h"
#include "batten/geometry/nurbs_curve.h"

namespace batten::internal {

// Where two curves come near: parameters on both, and how near.
struct ClosestApproach {
  double s, t;
  double gap;
};

// A curve with points along it.
class SampledCurve {
 public:
  // p + 1 samples a span, evenly, and two dozen at least.
  explicit SampledCurve(const NurbsCurve<3>& curve);

  const NurbsCurve<3>& curve() const { return evaluator_.curve(); }
  const CurveEvaluator<3>& evaluator() const { return evaluator_; }
  bool closed() const { return closed_; }
  const std::vector<double>& parameters() const { return parameters_; }
  const Eigen::Matrix3Xd& points() const { return points_; }

 private:
  CurveEvaluator<3> evaluator_;
  bool closed_;
  std::vector<double> parameters_;
  Eigen::Matrix3Xd points_;
};

// All places where the curves come within `tolerance`, the nearest first; where there are none, the
// nearest place alone. From every pair of samples that is nearer than its neighbours, by
// Gauss–Newton steps; what comes near between samples that do not tell goes unseen. Both ends of a
// closed curve are one place, its beginning. O(samples of a · samples of b).
std::vector<ClosestApproach> Meetings(const SampledCurve& a,
                                      const SampledCurve& b,
                                      double tolerance);

}  // namespace batten::internal
