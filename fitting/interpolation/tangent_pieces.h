// SPDX-License-Identifier: MIT
// Conic and cubic Bézier pieces between two points with given tangents.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "fitting/interpolation/bezier_chain.h"

namespace batten::internal {

// A point and the unit vector in which the curve passes through it.
template <int Dim>
struct DirectedPoint {
  Eigen::Matrix<double, Dim, 1> place, direction;
};

// One conic arc where the triangle exists; otherwise two, joined smoothly, that turn by half as
// much or have an inflection between them, in space each in a plane of its own. Rational arcs
// have the weight that makes them circular where triangles are isosceles; otherwise they are
// parabolas. [Piegl & Tiller 1997, §9.3.2, §9.3.3]
template <int Dim>
std::vector<ChainPiece<Dim>> ConicPieces(const DirectedPoint<Dim>& start,
                                         const DirectedPoint<Dim>& end,
                                         bool rational);

// The cubic whose speed is equal at both ends and in the middle. [Piegl & Tiller 1997, §9.3.4]
template <int Dim>
ChainPiece<Dim> CubicPiece(const DirectedPoint<Dim>& start, const DirectedPoint<Dim>& end);

}  // namespace batten::internal
