// SPDX-License-Identifier: MIT
// Maps of a surface onto the grid of integers.
#pragma once

#include <complex>
#include <vector>

#include "fitting/solid/surface_creases.h"
#include "fitting/solid/triangle_topology.h"

namespace batten::internal {

using Complex = std::complex<double>;

// Of the parallelogram that turns from a to b.
inline double AreaOf(Complex a, Complex b) { return std::imag(std::conj(a) * b); }

// A map of every triangle to the plane whose unit squares are the faces of a layout. Charts of
// triangles beside one another differ by quarter turns and integer translations.
struct GridMap {
  std::vector<Complex> corners;  // by half-edge: of its origin, in its triangle
  std::vector<int> turns;        // by half-edge: across it p becomes i^turn p + shift
  std::vector<Complex> shifts;   // with Gaussian integers
  int turned_over = 0;           // triangles

  Complex Across(int h, Complex p) const;
  Complex DirectionAcross(int h, Complex direction) const;
};

// The map whose unit steps are crosses of this length, in the mean of squares over the surface,
// with singular vertices at integers, and corners of creases or one vertex of each that closes.
// Along creases squares count far more, so that they become lines of the grid. Triangles that turn
// over are made stiffer a few times. [Bommes, Zimmer & Kobbelt 2009] Throws RefusedData where there
// is none.
GridMap MapOntoGrid(const TriangleSurface& surface,
                    const TriangleTopology& topology,
                    const std::vector<double>& crosses,
                    const Eigen::VectorXd& lengths,
                    const SurfaceCreases& creases = {});

}  // namespace batten::internal
