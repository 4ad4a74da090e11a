// SPDX-License-Identifier: MIT
// The result of a curve fit: final coordinates, residuals and termination.
#pragma once

#include "batten/fitting/curve_options.h"
#include "batten/fitting/ordered_points.h"
#include "batten/geometry/thread_pool.h"

namespace batten::internal {

// The inputs from which a fitted curve is measured.
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

// Moves the curve, given relative to `middle` in local coordinates, to its final coordinates,
// measures every point's distance from the result, rounding of far coordinates included, and sets
// the termination by what was measured. `report` holds the history of the stages.
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
