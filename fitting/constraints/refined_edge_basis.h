// SPDX-License-Identifier: MIT
// One direction of a constrained surface: coarse for what the points decide, fine for what its
// edges ask.
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <map>
#include <string>
#include <vector>

#include "batten/geometry/spline_basis.h"
#include "fitting/constraints/ready_edge.h"

namespace batten::internal {

// "the edge u = lower", …
std::string NameOf(const SurfaceEdge& edge);

// The curve over the basis' degree and exactly its domain; with the basis' knots where its own are
// next to them. Throws std::invalid_argument where the edge or its field does not suit the basis.
ReadyEdge ReadyFor(const FixedEdge& edge, const SplineBasis& along, const Eigen::Vector3d& centre);

// Bases of one degree, each with the knots of the one before.
struct RefinedEdgeBasis {
  SplineBasis coarse;
  SplineBasis least;  // with the knots of the curves and fields
  SplineBasis fine;
  Eigen::SparseMatrix<double> raised;  // column i: coarse function i over the fine basis
};

// About the speed of a curve: its size by its domain.
double SpeedOf(const NurbsCurve<3>& curve);

// The coarse functions over a basis with more knots, a column each.
Eigen::SparseMatrix<double> RaisedTo(const SplineBasis& finer, const SplineBasis& coarse);

// The curve over a basis with more knots.
NurbsCurve<3> RefinedTo(const SplineBasis& finer, const NurbsCurve<3>& curve);

// The basis with these simple knots more, each inside a span.
SplineBasis WithKnots(const SplineBasis& basis, const std::vector<double>& knots);

// The basis refined by the knots of the curves of the edges that run along it. Along an edge with a
// tangent field it is fine enough that every product of a coarse function with the field, or with
// the curve's derivative, is a spline over it to 1e-7 of their size, unless that takes more than
// some 1500 functions. The curves get its knots.
// Throws std::invalid_argument where a curve with a field has a corner, or the field vanishes or
// runs along the curve.
RefinedEdgeBasis RefinedEdgeBasisFor(const SplineBasis& coarse, std::vector<ReadyEdge>& edges);

}  // namespace batten::internal
