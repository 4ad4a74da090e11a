// SPDX-License-Identifier: MIT
// On which side of its edges a face is, and which of its own sides is outside.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "fitting/regions/face_borders.h"
#include "fitting/regions/grow_regions.h"

namespace batten::internal {

// Of the two faces of an edge: +1 where the face is on the left of it, its shape's normal upwards;
// −1: on the right.
using EdgeSides = std::pair<double, double>;

struct BorderSides {
  std::vector<EdgeSides> of;  // of every edge
  std::string refused;        // why they are not known, a sentence; empty: they are
};

// From where the face's points are about the edge. Of an edge without points beside it the side
// follows from the face's other edge at a vertex: where one arrives the other leaves.
BorderSides SidesOf(const RegionPoints& data,
                    const RegionLabels& labels,
                    const std::vector<BorderEdge>& edges);

struct FaceSides {
  std::vector<double> outward;  // of every face: +1 along the normal of its shape, −1 against it
  std::string refused;          // why there is no outside, a sentence; empty: there is
};

// So that the loops of its two faces run along an edge in opposite directions, and that at the
// point of a shell farthest from its middle the outside looks away from there.
FaceSides OutsidesOf(const RegionPoints& data,
                     const RegionLabels& labels,
                     const std::vector<BorderEdge>& edges,
                     const std::vector<EdgeSides>& sides);

}  // namespace batten::internal
