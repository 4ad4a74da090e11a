// SPDX-License-Identifier: MIT
// What faces of a part have in common, for the report.
#pragma once

#include <vector>

#include "batten/fitting/part_options.h"
#include "fitting/regions/face_relations.h"

namespace batten::internal {

// One entry for all that have a relation to the same face, with the deviation of the farthest off;
// perpendicular and tangent ones are of two faces each, and first. `face_of` numbers the faces of
// the relations, `unit` is that of their lengths, `kept` whether they hold exactly.
std::vector<RelationSummary> SummariseRelations(const std::vector<FaceRelation>& relations,
                                                const std::vector<int>& face_of,
                                                double unit,
                                                bool kept);

}  // namespace batten::internal
