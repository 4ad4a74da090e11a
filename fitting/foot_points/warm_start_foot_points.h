// SPDX-License-Identifier: MIT
// Warm-started foot points of many points on a curve that has moved little since the last search.
#pragma once

#include <Eigen/Core>

#include "batten/geometry/curve_evaluator.h"
#include "batten/geometry/thread_pool.h"

namespace batten::internal {

// Position, tangent and curvature terms of a curve at the foot points of m points.
template <int Dim>
struct WarmStartFootPoints {
  using Columns = Eigen::Matrix<double, Dim, Eigen::Dynamic>;

  Eigen::VectorXd parameters;
  Columns differences;  // C(u) − q
  Columns tangents;     // of length one, or zero where the curve stands still
  Eigen::VectorXd bend;  // (C − q)·C″ / |C′|²: distance over radius of curvature, negative for
                         // points on the side of its centre
  // At an end or a kink of the curve with a difference that is not perpendicular to the tangent.
  Eigen::Array<bool, Eigen::Dynamic, 1> held;

  double Squares(const Eigen::VectorXd& weights) const;  // Σ w |C − q|²; no weights: ones
};

// Descending Newton steps for |C(u) − q|² from the given parameters: the result is no farther from
// any point than the start is. They stop when the difference is perpendicular to the tangent to
// 1e-7. Steps stop at the ends of open curves and pass the seam of periodic ones. Only local minima
// are found. O(m), at some millions of points a second; results do not depend on the number of
// threads. [Piegl & Tiller 1997, §6.1]
template <int Dim>
WarmStartFootPoints<Dim> FootPointsFrom(const CurveEvaluator<Dim>& curve,
                                        const Eigen::Matrix<double, Dim, Eigen::Dynamic>& points,
                                        const Eigen::VectorXd& start,
                                        ThreadPool& pool);

extern template struct WarmStartFootPoints<2>;
extern template struct WarmStartFootPoints<3>;

}  // namespace batten::internal
