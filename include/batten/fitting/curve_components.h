// SPDX-License-Identifier: MIT
// Components of a cloud: the ordered points of each curve, and the outliers of no curve.
#pragma once

#include <string>
#include <vector>

#include "batten/fitting/curve_options.h"
#include "batten/fitting/curve_order.h"
#include "batten/fitting/ordered_points.h"
#include "batten/fitting/progress.h"

namespace batten {

struct ArrangeOptions {
  CurveParameterization parameterization = CurveParameterization::kChord;
  int degree = 3;  // for universal parameters
  PointOrder order = PointOrder::kAuto;
  ClosedChoice closed = ClosedChoice::kAuto;
  bool find_outliers = true;  // leave out points far from the line of their neighbours
};

struct CurveComponents {
  std::vector<OrderedPoints> curves;  // longest first; one where the cloud's order counts
  std::vector<double> lengths;        // of their polylines, unordered points only
  PointMask sequence_outliers;        // points of no curve
  bool unordered = false;             // the order was found from neighbourhoods
  std::vector<std::string> warnings;  // for the user, of the whole cloud
  std::vector<std::string> of_ends;   // of each curve's ends; empty: nothing is to be said
};

// Splits the cloud into curves, orders the points of each and gives them parameters. Throws
// std::invalid_argument, with a sentence for the user, where there is no curve to follow.
CurveComponents ArrangeCurves(const PointCloud& cloud,
                              const ArrangeOptions& options,
                              ThreadPool& pool,
                              const Progress& progress = {});

}  // namespace batten
