// SPDX-License-Identifier: MIT
// Fits Bézier pieces to a run of points with given end tangents.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "fitting/interpolation/bezier_chain.h"
#include "fitting/interpolation/tangent_pieces.h"

namespace batten::internal {

// One piece, or two in a row, and for every inner point of the run the place where it is within
// the tolerance.
template <int Dim>
struct FittedRun {
  struct Place {
    Eigen::Index piece;
    double u;  // in [0, 1]
  };
  std::vector<ChainPiece<Dim>> pieces;
  std::vector<Place> places;
  double largest = 0;  // distance
};

// The cubic from `start` to `end` whose two inner control points, free to move along the
// directions, come nearest to the inner points of the run in the least-squares sense of their
// distances. None where a point lies farther off than the tolerance.
// [Piegl & Tiller 1997, §9.5.2; Schneider 1990, "An algorithm for automatically fitting digitized
// curves"]
template <int Dim>
std::optional<FittedRun<Dim>> FitCubicRun(const DirectedPoint<Dim>& start,
                                          const DirectedPoint<Dim>& end,
                                          const Eigen::Matrix<double, Dim, Eigen::Dynamic>& inner,
                                          double tolerance);

// The conic arc in the triangle of both end tangents whose weight gives the least squared
// distances; where there is no triangle, as about an inflection, the two arcs of ConicPieces.
// [Piegl & Tiller 1997, §9.5.1]
template <int Dim>
std::optional<FittedRun<Dim>> FitConicRun(const DirectedPoint<Dim>& start,
                                          const DirectedPoint<Dim>& end,
                                          const Eigen::Matrix<double, Dim, Eigen::Dynamic>& inner,
                                          double tolerance);

}  // namespace batten::internal
