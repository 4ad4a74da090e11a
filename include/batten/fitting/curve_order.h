// SPDX-License-Identifier: MIT
// The order of unordered points along the curves they were measured on.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "batten/fitting/curve_options.h"
#include "batten/fitting/point_cloud.h"
#include "batten/fitting/progress.h"
#include "batten/geometry/thread_pool.h"

namespace batten {

struct CurveOrderOptions {
  ClosedChoice closed = ClosedChoice::kAuto;
};

// One curve of a cloud, lengths in the data's units.
struct CurvePath {
  std::vector<Eigen::Index> points;  // of the cloud, in order along the curve
  Eigen::VectorXd parameters;        // arc length along the guide for each, non-decreasing
  Eigen::Matrix3Xd guide;            // corners of a polyline along the middle of the points, in
                                     // order, local like the cloud's; closed: first not repeated
  bool closed = false;
  double length = 0;   // of the guide
  double gap = 0;      // open: from end to end; closed: the longest step from point to point
  double spacing = 0;  // length divided by the number of points
  double noise = 0;    // standard deviation across the guide in each direction, from the median
};

struct CurveOrder {
  std::vector<CurvePath> paths;        // longest first
  std::vector<Eigen::Index> outliers;  // points of no path, ascending
  // Whether the points show these curves: they are long against the noise across them, turn little
  // from node to node and leave out few points. Else they are a guess, as on points of a surface.
  bool evident = false;
};

// Finds the curves and the order along each. Where the noise exceeds the spacing, the middle line
// of the points is found first; else the guide goes through the points. Exact duplicates follow one
// another. Points far from every curve and groups of fewer than five (four that close) are
// outliers. The result does not depend on the order in which the points are given. Curves that come
// nearer to each other than about four spacings, or 16 times the noise, cannot be told apart.
// Throws std::invalid_argument where there are fewer than two different points, and where curves
// branch or cross, with the place; Cancelled when progress asks to stop. O(m log m), half a second
// for 200 000 points.
CurveOrder OrderAlongCurves(const PointCloud& cloud,
                            const CurveOrderOptions& options,
                            ThreadPool& pool,
                            const Progress& progress = {});

}  // namespace batten
