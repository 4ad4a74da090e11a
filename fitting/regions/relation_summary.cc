// SPDX-License-Identifier: MIT
#include "fitting/regions/relation_summary.h"

#include <map>
#include <utility>

namespace batten::internal {
namespace {

bool OfTwo(RelationKind kind) {
  return kind == RelationKind::kPerpendicular || kind == RelationKind::kTangent;
}

bool IsAngle(RelationKind kind) {
  return kind == RelationKind::kParallel || kind == RelationKind::kPerpendicular;
}

}  // namespace

std::vector<RelationSummary> SummariseRelations(const std::vector<FaceRelation>& relations,
                                                const std::vector<int>& face_of,
                                                double unit,
                                                bool kept) {
  std::vector<RelationSummary> summaries;
  std::map<std::pair<RelationKind, int>, RelationSummary> groups;
  for (const FaceRelation& relation : relations) {
    const RelationKind kind = relation.kind;
    const double scale = IsAngle(kind) ? 1 : unit;
    RelationSummary& group = groups[{kind, relation.first}];
    if (group.faces.empty() || OfTwo(kind))
      group = {Name(kind), {face_of[std::size_t(relation.first)]}, 0, 1, kept};
    group.faces.push_back(face_of[std::size_t(relation.second)]);
    if (relation.deviation * group.allowed >= group.deviation * relation.allowed) {
      group.deviation = scale * relation.deviation;
      group.allowed = scale * relation.allowed;
    }
    if (OfTwo(kind)) summaries.push_back(group);
  }
  for (auto& [key, group] : groups) {
    if (!OfTwo(key.first)) summaries.push_back(std::move(group));
  }
  return summaries;
}

}  // namespace batten::internal
