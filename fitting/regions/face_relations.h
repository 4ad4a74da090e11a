// SPDX-License-Identifier: MIT
// What the faces of a part have in common, and their fit under it.
#pragma once

#include <vector>

#include "batten/geometry/thread_pool.h"
#include "fitting/regions/grow_regions.h"
#include "fitting/regions/region_face.h"
#include "fitting/regions/region_points.h"
#include "fitting/regions/smooth_contact.h"

namespace batten::internal {

enum class RelationKind { kParallel, kPerpendicular, kCoaxial, kCoplanar, kEqualRadius, kTangent };

// "parallel", "perpendicular", …
const char* Name(RelationKind kind);

// Of two faces, the first of which is the better known.
struct FaceRelation {
  RelationKind kind;
  int first, second;
  double deviation = 0;        // radians, or a length in units of RegionPoints
  double allowed = 0;          // the greatest that one case in a thousand of chance explains
  SmoothContact contact = {};  // of tangent ones
  // How far faces may leave their points for it: where they do not close without, or are off the
  // contact by noise of their own.
  double moves = 0;
};

// Two faces whose shapes have nearly the same normals where they are neighbours.
struct FaceJoin {
  int first, second;
  Eigen::Vector3d near;  // a place of their border
};

// Of all regions with more than some neighbouring points.
std::vector<FaceJoin> SmoothJoins(const RegionPoints& data, const RegionLabels& labels);

// The relations that the faces' covariances do not reject, χ² at a thousandth, and that they tell:
// angles to a degree, lengths to a hundredth of the size, radii to a tenth. Of faces that are all
// parallel, coaxial, coplanar or of one radius each has its relation to the best known of them;
// perpendicular are those best known. Coaxial and coplanar faces are parallel besides. Tangent are
// faces of the joins that touch along a curve as far as one case in a million tells, for of those
// nothing else is expected; what a face has more noise than most of (kNoisier) may be off the same
// way at all of its points, as facets are.
std::vector<FaceRelation> FindRelations(const RegionPoints& data,
                                        const std::vector<RegionFace>& faces,
                                        const std::vector<FaceJoin>& joins,
                                        ThreadPool& pool);

// The shapes of least Σ (d/σ)² over all faces' core points under the relations, exactly: Gauss–
// Newton steps over all freedoms with multipliers. [Fletcher 1987, §10] O(relations³) a step. Where
// faces leave their points by more than chance explains of all their relations, not all of these
// hold together: the least likely are taken out, one after the other, as are tangent ones of shapes
// that come to where they can't touch.
std::vector<FittedSurface> ShapesUnder(const RegionPoints& data,
                                       const std::vector<RegionFace>& faces,
                                       std::vector<FaceRelation>& relations,
                                       ThreadPool& pool);

}  // namespace batten::internal
