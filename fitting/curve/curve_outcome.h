// SPDX-License-Identifier: MIT
// A fitted curve as it is handed out, measured and judged.
#pragma once

#include "batten/fitting/curve_options.h"
#include "batten/fitting/ordered_points.h"
#include "batten/geometry/thread_pool.h"

namespace batten::internal {

// What a fit rests on.
struct MeasureInput {
  const PointCloud& cloud;
  const OrderedPoints& ordered;
  const PointMask& sequence_outliers;
  const CurveFitOptions& options;
  const Eigen::VectorXd& weights;  // of the ordered points in the end; empty: ones
  Eigen::VectorXd parameters;      // of the ordered points, near their foot points
  CurveDistance distance;          // kParameter or kPoint: what was fitted
  double noise;                    // standard deviation across the curve, per coordinate
  int control_points;              // that differ
};

// The curve, given less the points' middle in local coordinates, moved to its place; every point's
// distance from it as it is handed out, rounding of far coordinates included; and the word for how
// the fit ended, held against what was measured. The report brings the stages' history.
template <int Dim>
CurveFit<Dim> MeasuredCurve(const MeasureInput& grounds,
                            const NurbsCurve<Dim>& curve,
                            const Eigen::Matrix<double, Dim, 1>& middle,
                            FitReport report,
                            ThreadPool& pool);

extern template CurveFit<2> MeasuredCurve<2>(
    const MeasureInput&, const NurbsCurve<2>&, const Eigen::Vector2d&, FitReport, ThreadPool&);
extern template CurveFit<3> MeasuredCurve<3>(
    const MeasureInput&, const NurbsCurve<3>&, const Eigen::Vector3d&, FitReport, ThreadPool&);

}  // namespace batten::internal
