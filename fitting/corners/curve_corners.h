// SPDX-License-Identifier: MIT
// Corner detection in points along a curve.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "fitting/corners/corner_options.h"

namespace batten::internal {

// Finds the corners, in the order of their parameters. `points` (3 × m; plane ones have z = 0)
// follow the curve, `parameters` increase and are about arc length; those of a closed curve span no
// more than a period, and span all of it only if its last point repeats the first.
//
// Where noise is far below the spacing every point counts: a corner is a turn that neither side
// announces, at a point or between two. A turn that is spread over less than about a spacing cannot
// be told from a corner and is one; with two points or fewer on a side nothing is claimed. Where
// noise matters, windows of growing size are fitted by a parabola with one kink, and a corner is a
// kink that explains them better than smooth curves do, better than a turn that takes half the
// window, and not worse than a turn a little rounded: what is rounded by less than noise can tell
// is a corner. Their sides must be long, about 40 points and 35 standard deviations of the noise
// from half a spacing of noise on: shorter bends of smooth curves look the same. Single outliers do
// not count. Corners that noise hides are not found; at the ends of an open curve there are none.
// O(m log m).
//
// Throws std::invalid_argument where sizes differ, parameters do not increase or a closed curve's
// exceed the period.
std::vector<CurveCorner> FindCorners(const Eigen::Matrix3Xd& points,
                                     const Eigen::VectorXd& parameters,
                                     const CornerOptions& options = {});

}  // namespace batten::internal
