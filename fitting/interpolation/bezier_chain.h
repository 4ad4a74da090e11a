// SPDX-License-Identifier: MIT
// Joins a chain of Bézier pieces into one NURBS curve.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "batten/geometry/nurbs_curve.h"

namespace batten::internal {

// A Bézier piece of degree p, whose first and last weight are 1.
template <int Dim>
struct ChainPiece {
  Eigen::Matrix<double, Dim, Eigen::Dynamic> points;  // Dim × (p + 1)
  Eigen::VectorXd weights;                            // p + 1
  bool smooth = true;  // goes on into the next piece (closed: the last into the first) without a
                       // corner: the three points there lie on a line
};

template <int Dim>
struct Chain {
  NurbsCurve<Dim> curve;
  Eigen::VectorXd breaks;  // where pieces begin, and the end
};

// Joins the pieces over [0, 1], in the order given, each beginning where the last one ends. Where
// they are smooth, the lengths of their domains make the curve C¹, and between polynomials the
// common point is no control point (knots of multiplicity p − 1). Domain lengths that would drift
// out of proportion to the pieces' lengths restart from those; there, at corners and beside
// rational pieces knots have multiplicity p. Closed: periodic, from the first piece round to it.
// O(pieces).
template <int Dim>
Chain<Dim> Chained(const std::vector<ChainPiece<Dim>>& pieces, bool closed);

extern template Chain<2> Chained<2>(const std::vector<ChainPiece<2>>&, bool);
extern template Chain<3> Chained<3>(const std::vector<ChainPiece<3>>&, bool);

}  // namespace batten::internal
