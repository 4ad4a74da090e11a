// SPDX-License-Identifier: MIT
// The curves that edges of a surface are given.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "batten/fitting/neighbours.h"
#include "batten/fitting/surface_options.h"
#include "batten/geometry/direction.h"
#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"

namespace batten::internal {

// An edge of a neighbouring surface: where the parameter of `direction` is at an end.
struct NeighbourEdge {
  NurbsSurface surface;
  Direction direction = Direction::kU;
  bool upper = false;
};

// A curve that an edge of the surface is to be, in the cloud's local coordinates.
struct BoundaryEdge {
  NurbsCurve<3> curve;                     // polynomial and clamped
  std::optional<NeighbourEdge> neighbour;  // whose edge the curve is
  std::string name;
  bool reversed = false;  // against the neighbour's edge
};

// The curves of the conditions; of a neighbour that edge which runs along the points. Curves are
// freed of knots within the tolerance asked for, and rational ones followed by cubics within that,
// or 1e-10 of the size. Throws std::invalid_argument, with a sentence for the user, where a curve
// is closed or has no length, or runs far from the points.
std::vector<BoundaryEdge> BoundaryEdges(const SurfaceFitOptions& options,
                                        const Eigen::Vector3d& origin,
                                        const Eigen::Matrix3Xd& points,
                                        const NeighbourIndex& index,
                                        double spacing);

// Places along a side for every half spacing of its length, not too few and not too many; with
// their parameters.
struct SideSamples {
  Eigen::VectorXd parameters;
  Eigen::Matrix3Xd points;
};
SideSamples SampleSide(const BoundaryEdge& side, double spacing);

// The same in the other direction, over the same interval.
BoundaryEdge Turned(const BoundaryEdge& side);

}  // namespace batten::internal
