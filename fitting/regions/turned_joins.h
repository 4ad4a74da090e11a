// SPDX-License-Identifier: MIT
// Faces that go on smoothly from one that turns about a known axis, and turn about it too.
#pragma once

#include <vector>

#include "fitting/regions/face_relations.h"

namespace batten::internal {

// A narrow face tells neither its axis nor, often, its kind: of a cone a few spacings wide a
// cylinder explains the points as well. Where a face joins others smoothly and touches none of
// them, but the cylinder, plane, cone or torus through its points about the axis of one is not
// rejected by these, it becomes that, and tangent to the other: `relations` gets that, and loses
// what its former shape had. `related` are the faces' shapes under the relations, axes that are one
// exactly so. Whether any face is changed.
bool TurnBeside(const RegionPoints& data,
                const std::vector<FaceJoin>& joins,
                double sigma,
                std::vector<FittedSurface> related,
                std::vector<RegionFace>& faces,
                std::vector<FaceRelation>& relations);

}  // namespace batten::internal
