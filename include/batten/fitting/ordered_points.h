// SPDX-License-Identifier: MIT
// Points along a curve: their parameters, and what they say of themselves.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "batten/fitting/curve_order.h"
#include "batten/fitting/curve_parameterization.h"
#include "batten/fitting/point_cloud.h"
#include "batten/fitting/point_mask.h"

namespace batten {

// Points in increasing order of their parameters. Points in a row that agree in place, and in
// parameter where that is given, are one point with their weights added.
struct OrderedPoints {
  PointCloud cloud;
  Eigen::VectorXd parameters;       // in [lower, upper]; closed: below upper
  double lower = 0, upper = 1;      // the domain; closed: one period
  Eigen::VectorXd lengths;          // along the curve from the first point, about; noise left out
  double length = 0;                // of the whole, back to the first point where closed
  bool closed = false;              // from the last point on to the first
  double gap = 0;                   // between those two
  std::vector<Eigen::Index> place;  // for every point given, the one that stands for it; -1: none
  Eigen::Index repeats = 0;         // points that vanished into another
  double spacing = 0;               // mean distance of neighbours in this order
  // Standard deviation across the curve, from each point's distance to the cubic through two
  // neighbours on either side; their median, so that single points do not count. 0 below 12 points.
  double noise = 0;
};

struct OrderOptions {
  CurveParameterization parameterization = CurveParameterization::kChord;
  int degree = 3;           // for universal parameters
  bool keep_order = false;  // given parameters must not decrease
  bool closed = false;  // parameters not given: the curve goes on from the last point to the first
  // Points that belong to no curve, or to another; empty: all belong.
  PointMask left_out = {};
};

// Given parameters may come in any order unless `keep_order` is set. All others follow the order of
// the points; where these lie closer than their noise allows to tell apart, steps are those of
// means of several in a row, and even inside; Foley's and universal parameters take single points.
// Throws std::invalid_argument, with a sentence for the user, where there are fewer than two
// different points, parameters are missing, all equal, too close together for their size to be told
// apart, or decrease where they must not; and where points differ by less than 1e-100 or parameters
// by less than 1e-60. O(m log m). [Piegl & Tiller 1997, §9.2.1]
OrderedPoints OrderPoints(const PointCloud& cloud, const OrderOptions& options);

// The points of a path in its order, parameters in proportion to the arc length of its guide, on
// [0, 1].
OrderedPoints FollowPath(const PointCloud& cloud, const CurvePath& path);

}  // namespace batten
