// SPDX-License-Identifier: MIT
// Holes of three to six sides filled with surfaces that join their neighbours smoothly.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "batten/geometry/fill_side.h"
#include "batten/geometry/nurbs_surface.h"

namespace batten {

struct FillOptions {
  // The widest gap between ends of sides, and what the filling may leave the sides by; the data's
  // units, > 0. Unset: 1e-6 of the diagonal of the box of the sides.
  std::optional<double> tolerance = {};
  double angle_tolerance = 1e-4;  // between tangent planes across edges, in radians, > 0
  int max_spans = 16;             // of the filling along half a side, a power of two in [1, 32]
};

// Of patches against the sides of their hole, at some dozens of places in every span of every edge.
struct FillQuality {
  double position_gap = 0;  // from the sides; the data's units
  double inner_angle = 0;   // between tangent planes of patches along their edges, radians
  double outer_angle = 0;   // between those of patches and neighbours; 0 without neighbours

  bool Within(double tolerance, double angle_tolerance) const {
    return position_gap <= tolerance && inner_angle <= angle_tolerance &&
           outer_angle <= angle_tolerance;
  }
};

struct HoleFill {
  std::vector<NurbsSurface> patches;  // one at every corner, of degree 5; neighbours share an edge
  FillQuality quality;
  int spans = 0;         // of the filling along half a side
  double tolerance = 0;  // that was kept, or not
  bool reached = false;  // both tolerances
};

// Every patch spans from the hole's centre, which is found, over the halves of two sides to their
// corner. Sides are taken by arc length as quintic splines; the control points inside are those of
// least bending energy among all that keep, to least squares with multipliers, (1) along edges
// between patches A and B: A's and B's derivatives across it sum to 2 cos(2π/n) (1 − t)² times the
// derivative along it, t from the centre outwards; (2) along neighbours: no derivative across along
// their normal. Spans are halved until the tolerances are reached; what cannot be (sides with
// kinks, neighbours whose tangent planes disagree at a corner, over a quarter of their side) is
// said in the result. Throws std::invalid_argument unless there are three to six sides that form
// one loop (in any order and sense; the gap is said), options are in range, and no neighbour is
// trimmed. A second or so. [Hahn 1989; Peters 1991; augmented Lagrangian: Hestenes 1969]
HoleFill Fill(const std::vector<FillSide>& sides, const FillOptions& options = {});

// The tolerance of the options, or 1e-6 of the size of the sides.
double FillTolerance(const std::vector<FillSide>& sides, const FillOptions& options);

// Of the patches that Fill makes, in its order, against the same sides. Throws as Fill.
FillQuality MeasureFill(const std::vector<NurbsSurface>& patches,
                        const std::vector<FillSide>& sides,
                        const FillOptions& options = {});

}  // namespace batten
