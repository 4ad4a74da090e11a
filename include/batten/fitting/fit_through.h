// SPDX-License-Identifier: MIT
// Curve fits that go exactly through some points, in directions where these are given.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "batten/fitting/curve_options.h"
#include "batten/fitting/point_cloud.h"

namespace batten {

// What the curve meets exactly, in world coordinates; plane curves take the first two.
struct MetPlace {
  Eigen::Vector3d point;
  // The tangent's direction there, of either sense; any length but zero.
  std::optional<Eigen::Vector3d> direction = std::nullopt;
  // Of fits at given parameters: where it is met.
  std::optional<double> parameter = std::nullopt;
};

// Fits a curve to the cloud as FitCurve does, without its joint stage, and then over its knots the
// curve of least squares, weighted as the cloud is and without the outliers, among those that meet
// every place (ConstrainedLeastSquares). A place is met where it is nearest to the free fit, at the
// end of an open curve where that is not between the points, and along a direction the curve is as
// fast as the free fit is along it; points are moved to their foot points and the curve is solved
// again until their distances settle. Where the fit is at given parameters (CurveDistance) points
// stay at theirs, and a place is met at its own parameter, or that of a point in the same place.
// Knots are inserted where places need more control points than there are, and within a tolerance
// where points are out. Places are met to 1e-9 of the points' size, usually to rounding; the report
// warns of those that are farther from the free fit than its residuals explain. Throws
// std::invalid_argument, with a sentence for the user, as FitCurve does; where a place is not
// finite or a direction has no length; where places contradict one another: two at one point of the
// curve, or more than its degree + 1 between two knots that can't be told apart; and where they and
// the points leave control points undetermined. [Piegl & Tiller 1997, §9.4.2]
template <int Dim>
CurveFit<Dim> FitCurveThrough(const PointCloud& cloud,
                              const std::vector<MetPlace>& places,
                              const CurveFitOptions& options = {});

extern template CurveFit<2> FitCurveThrough<2>(const PointCloud&,
                                               const std::vector<MetPlace>&,
                                               const CurveFitOptions&);
extern template CurveFit<3> FitCurveThrough<3>(const PointCloud&,
                                               const std::vector<MetPlace>&,
                                               const CurveFitOptions&);

}  // namespace batten
