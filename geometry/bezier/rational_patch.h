// SPDX-License-Identifier: MIT
// Bézier patches in homogeneous coordinates: products, differences, and the farthest point. A curve
// is a patch of degree 0 in the second direction. Internal to geometry.
#pragma once

#include <Eigen/Core>
#include <utility>
#include <vector>

#include "batten/geometry/direction.h"

namespace batten::internal {

// Columns i·(q+1) + j are (w·P, w) of control point (i,j); one row for each coordinate and one for
// w.
struct RationalPatch {
  int p, q;
  Eigen::MatrixXd columns;
};

// The two parts of a patch halved across a direction. De Casteljau at 1/2.
std::pair<RationalPatch, RationalPatch> Halved(const RationalPatch& patch, Direction direction);

// Rows of f, a polynomial of degrees (m,n) in the order of a patch, times g, of degrees (r,s).
Eigen::MatrixXd PatchProduct(
    const Eigen::MatrixXd& f, int m, int n, const Eigen::RowVectorXd& g, int r, int s);

// a − b as one patch. Where both have weights one only, so has the result, and its degrees are the
// greater ones; otherwise they are the sums, and the weights the products.
RationalPatch Difference(const RationalPatch& a, const RationalPatch& b);

// An upper bound of the distance from the origin of the farthest point of all patches: at most 1 %
// above it, or less than `negligible`; see DeviationBound for `enough`.
double FarthestBound(std::vector<RationalPatch> patches, double negligible, double enough);

}  // namespace batten::internal
