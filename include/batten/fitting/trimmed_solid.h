// SPDX-License-Identifier: MIT
// A solid of trimmed planes, cylinders, cones, spheres and tori that share their edges and
// vertices.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "batten/geometry/classify_shape.h"
#include "batten/geometry/exact_shape.h"
#include "batten/geometry/nurbs_curve.h"

namespace batten {

struct TrimmedSolidEdge {
  NurbsCurve<3> curve;
  std::optional<ExactCurve> exact = std::nullopt;  // where it is a segment or arc, the same way
  int start = 0, end = 0;                          // vertices; one vertex where it is closed
};

struct TrimmedSolidCoedge {
  int edge = 0;
  bool reversed = false;  // the loop runs against the curve
};

// A part of a plane, cylinder, cone, sphere or torus.
struct TrimmedSolidFace {
  SurfaceShape carrier;
  // Outwards is against the natural normal: that of a plane, and away from axis or centre of
  // others.
  bool reversed = false;
  // The face is on the left of its loops seen from outside; none: the whole sphere or torus.
  std::vector<std::vector<TrimmedSolidCoedge>> loops;
};

// Faces of closed shells: every edge belongs to two of them, or twice to one, in opposite
// directions.
struct TrimmedSolid {
  Eigen::Matrix3Xd vertices;
  std::vector<TrimmedSolidEdge> edges;
  std::vector<TrimmedSolidFace> faces;
};

// What a solid has. Seams of round faces are edges.
struct SolidCensus {
  int solids = 0, faces = 0, edges = 0;
  double volume = 0, area = 0;
};

}  // namespace batten
