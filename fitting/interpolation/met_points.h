// SPDX-License-Identifier: MIT
// The points of a cloud in the order of a curve, and the fit that a curve through them is.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

#include "batten/fitting/curve_options.h"
#include "batten/fitting/interpolate_curve.h"
#include "batten/fitting/ordered_points.h"

namespace batten::internal {

// Points that differ from their neighbours, as the curve meets them, with their parameters where
// these are given: as many as points, closed one more.
template <int Dim>
struct MetPoints {
  OrderedPoints ordered;
  Eigen::Matrix<double, Dim, Eigen::Dynamic> points;
  Eigen::VectorXd parameters;
  bool ends_meet = false;  // the last of the ordered points is the first again and left out
};

// Closed: over given parameters the curve is back at the first point at the last parameter, if the
// last point is the first again; otherwise the step back is as long for its chord as the others are
// on average. Throws std::invalid_argument, with a sentence for the user, as OrderPoints does and
// where two different points have one parameter.
template <int Dim>
MetPoints<Dim> MetPointsOf(const PointCloud& cloud, bool given, bool keep_order, bool closed);

struct MetPointsReport {
  std::string base;  // of the parameters
  std::string why;   // why nothing is optimised
  bool closed = false;
  bool meets_all = true;  // residuals are at the parameters; else orthogonal distances from there
  std::optional<double> tolerance = std::nullopt;
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();
};

// What the curve, in coordinates of the cloud, is as a fit of all points, with errors measured on
// the curve that is returned; the report lacks the seconds.
template <int Dim>
CurveFit<Dim> FitThroughPoints(const PointCloud& cloud,
                               const MetPoints<Dim>& met,
                               const InterpolatedCurve<Dim>& local,
                               const MetPointsReport& how);

}  // namespace batten::internal
