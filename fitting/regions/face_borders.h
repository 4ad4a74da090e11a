// SPDX-License-Identifier: MIT
// Where the faces of a part meet: places on two of them, vertices on three, edges between vertices.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "fitting/regions/border_vertices.h"

namespace batten::internal {

struct BorderEdge {
  FacePair faces;
  int start = -1, end = -1;  // vertices; −1 both where it is closed
  Eigen::Matrix3Xd points;   // on both faces, in order; of a closed one the first is not repeated
  int shown = 0;             // how many places are along it, away from vertices
};

struct FaceBorders {
  std::vector<BorderVertex> vertices;
  std::vector<BorderEdge> edges;
  std::string refused;  // why they do not close, a sentence; empty: they do
};

// From pairs of neighbouring points of two regions: places on the shapes of both; vertices where
// points of three regions are near; edges followed from vertex to vertex, or round, along the
// places that the points show. A border that is lost ends where its curve meets a third face whose
// points are near: a corner of its own.
FaceBorders FindBorders(const FaceMeets& meets);

}  // namespace batten::internal
