// SPDX-License-Identifier: MIT
// How far a triangle with its corners on a surface is from it. Internal to geometry.
#pragma once

#include <Eigen/Core>
#include <array>

#include "batten/geometry/surface_evaluator.h"

namespace batten::internal {

// The corners of a triangle: parameters, points there, and which edges (opposite the corner) have
// to follow the surface as lines, not only as parts of a plane.
struct SurfaceTriangle {
  std::array<Eigen::Vector2d, 3> parameters;
  std::array<Eigen::Vector3d, 3> points;
  std::array<bool, 3> lines;
};

struct TriangleError {
  double distance;           // an estimate of the greatest, see Tessellate
  std::array<int, 3> worst;  // the edges, those to be halved first in front
};

// Distances count along the normal: a triangle may lie elsewhere in the surface than its
// parameters say. Where it is turned by more than 60° against the surface, and longer than the
// tolerance, the distance is its length. Four to seven jets and three to nine points of the
// surface.
TriangleError ErrorOf(const SurfaceTriangle& triangle,
                      const SurfaceEvaluator& surface,
                      double tolerance);

// The edges in the order in which they should be halved where the surface at the place inside is
// farther off than the triangle's own four places show: those along which it bends most there, or
// the longest where it bends along none.
std::array<int, 3> EdgesAt(const SurfaceTriangle& triangle,
                           const SurfaceEvaluator& surface,
                           const Eigen::Vector2d& place,
                           double tolerance);

}  // namespace batten::internal
