// SPDX-License-Identifier: MIT
// The polar form (blossom) of a spline at sets of knots, as combinations of its control points.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "geometry/editing/control_rows.h"
#include "batten/geometry/spline_basis.h"

namespace batten::internal {

// A mean of p+1 neighbouring control points of which the first has number `first`. Coefficients of
// numbers outside 0 … n−1 are zero.
struct ControlMean {
  int first;
  Eigen::VectorXd coefficients;
};

// f[v_1, …, v_p] for a spline f of degree p: over any refined knot vector in which `before`, v_1,
// …, v_p are neighbours in this order, this is the control point that belongs to v_1 … v_p. All
// coefficients are ≥ 0, their sum is 1, each is right to 3p·ε of itself. The refined knot vector
// has every knot of the basis at least as often as the basis, equal bit by bit, and `before` is one
// of the basis' knots. O(p²). [Cohen, Lyche & Riesenfeld 1980 (the Oslo algorithm); Ramshaw 1989]
ControlMean PolarMean(const SplineBasis& basis, double before, std::span<const double> arguments);

// Control points over `refined`: the knots of the basis, none of them less often, and others among
// them; beyond the domain it may have fewer, so that the outermost control points do not count. Row
// i gives control point i.
std::vector<ControlMean> RefinementMeans(const SplineBasis& basis, const SplineBasis& refined);

// Control points of degree p+1 over `elevated`, whose knots are repeated once more than those of
// the basis: each is the mean of the p+1 values of the polar form that leave one of its knots out.
// All coefficients are ≥ 0. [Ramshaw 1989; Liu 1997]
std::vector<ControlMean> ElevationMeans(const SplineBasis& basis, const SplineBasis& elevated);

// The rows over `basis` whose control points are these means, taken in homogeneous coordinates.
// Control points that coincide give control points that coincide with them, bit by bit.
ControlRows Combined(const std::vector<ControlMean>& means,
                     const ControlRows& rows,
                     SplineBasis basis);

}  // namespace batten::internal
