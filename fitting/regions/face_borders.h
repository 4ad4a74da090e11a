// SPDX-License-Identifier: MIT
// Where the faces of a part meet: places on two of them, vertices on three, edges between vertices.
#pragma once

#include <Eigen/Core>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "fitting/regions/grow_regions.h"

namespace batten::internal {

using FacePair = std::pair<int, int>;  // ascending

// The place on all of two shapes or more nearest to `from`, by Gauss–Newton steps; none where they
// do not settle on it within `reach`, or the shapes are near to tangent.
std::optional<Eigen::Vector3d> PlaceOn(const std::vector<const FittedSurface*>& shapes,
                                       Eigen::Vector3d from,
                                       double reach);

struct BorderVertex {
  Eigen::Vector3d place;
  std::vector<int> faces;  // ascending, three or more
};

struct BorderEdge {
  FacePair faces;
  int start = -1, end = -1;  // vertices; −1 both where it is closed
  Eigen::Matrix3Xd points;   // on both faces, in order; of a closed one the first is not repeated
};

struct FaceBorders {
  std::vector<BorderVertex> vertices;
  std::vector<BorderEdge> edges;
  std::string refused;  // why they do not close, a sentence; empty: they do
};

// From pairs of neighbouring points of two regions: places on the shapes of both; vertices where
// points of three regions are near; edges followed from vertex to vertex, or round, along the
// places that the points show. Vertices nearer than `same`, which is noise, are one. `contacts` has
// the normals along the curve where two faces touch exactly (NormalsAlong): it is their border.
FaceBorders FindBorders(const RegionPoints& data,
                        const RegionLabels& labels,
                        const std::map<FacePair, FittedSurface>& contacts,
                        double same);

}  // namespace batten::internal
