// SPDX-License-Identifier: MIT
// Faces with their borders as a solid.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "batten/fitting/trimmed_solid.h"
#include "fitting/regions/face_borders.h"
#include "fitting/regions/grow_regions.h"

namespace batten::internal {

struct ClosedSolid {
  std::optional<TrimmedSolid> solid;  // in the coordinates of the result
  std::string refused;                // why there is none, a sentence
  int shells = 0, genus = 0;
  double invented = 0;  // of its area, the share without points near
};

// The solid whose faces are the regions. Edges are segments and arcs where they are, else cubic
// curves through places on both faces. Loops follow from which side of an edge the face's points
// are on; which side of a face is outside from its neighbours' and from the outermost point.
// `move` is what coordinates of the cloud gain. Refused where more than `most_invented` of the area
// has no points near, or one shell lies in another. `contacts`: see FindBorders.
ClosedSolid CloseSolid(const RegionPoints& data,
                       const RegionLabels& labels,
                       const std::map<FacePair, FittedSurface>& contacts,
                       double sigma,
                       double most_invented,
                       const Eigen::Vector3d& move);

}  // namespace batten::internal
