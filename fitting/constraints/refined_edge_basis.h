// SPDX-License-Identifier: MIT
// The bases of one direction of a constrained surface: coarse for the points, fine for the edges.
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <map>
#include <string>
#include <vector>

#include "batten/geometry/spline_basis.h"
#include "fitting/constraints/ready_edge.h"

namespace batten::internal {

// The edge's name, such as "the edge u = lower".
std::string NameOf(const SurfaceEdge& edge);

// Raises the curve to the basis' degree and maps it to exactly its domain; knots next to those of
// the basis are moved onto them. Throws std::invalid_argument where the edge or its field does not
// suit the basis.
ReadyEdge ReadyFor(const FixedEdge& edge, const SplineBasis& along, const Eigen::Vector3d& centre);

// Nested bases of one degree, each with the knots of the one before.
struct RefinedEdgeBasis {
  SplineBasis coarse;
  SplineBasis least;  // with the knots of the curves and fields
  SplineBasis fine;
  Eigen::SparseMatrix<double> raised;  // column i: coarse function i over the fine basis
};

// The approximate speed of a curve: its size divided by the length of its domain.
double SpeedOf(const NurbsCurve<3>& curve);

// Refines the basis by the knots of the edge curves that run along it. For an edge with a tangent
// field the fine basis represents every product of a coarse function with the field, or with the
// curve's derivative, to 1e-7 of their size, unless that needs more than some 1500 functions. The
// curves are refined to the fine basis. Throws std::invalid_argument where a curve with a field has
// a corner, or the field vanishes or runs along the curve.
RefinedEdgeBasis RefinedEdgeBasisFor(const SplineBasis& coarse, std::vector<ReadyEdge>& edges);

}  // namespace batten::internal
