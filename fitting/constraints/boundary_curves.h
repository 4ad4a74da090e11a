// SPDX-License-Identifier: MIT
// Boundary curves given for edges of a surface.
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

// A prescribed boundary curve of the surface, in the cloud's local coordinates.
struct BoundaryEdge {
  NurbsCurve<3> curve;                     // polynomial and clamped
  std::optional<NeighbourEdge> neighbour;  // the surface whose edge the curve is
  std::string name;
  bool reversed = false;  // against the neighbour's edge
};

// The curves of the boundary conditions; for a neighbour, the edge that runs along the points.
// Knots are removed from curves within options.boundary_tolerance, and rational curves approximated
// by cubics within that, or 1e-10 of the size. Throws std::invalid_argument, with a sentence for
// the user, where a curve is closed or has no length, or runs far from the points.
std::vector<BoundaryEdge> BoundaryEdges(const SurfaceFitOptions& options,
                                        const Eigen::Vector3d& origin,
                                        const Eigen::Matrix3Xd& points,
                                        const NeighbourIndex& index,
                                        double spacing);

// Samples of a side at every half spacing of its length, bounded in number, with their parameters.
struct SideSamples {
  Eigen::VectorXd parameters;
  Eigen::Matrix3Xd points;
};
SideSamples SampleSide(const BoundaryEdge& side, double spacing);

// The side reversed, over the same interval.
BoundaryEdge Turned(const BoundaryEdge& side);

}  // namespace batten::internal
