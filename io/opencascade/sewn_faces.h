// SPDX-License-Identifier: MIT
// Faces sewn together where their edges meet. Not installed; includes OpenCASCADE.
#pragma once

#include <TopoDS_Face.hxx>
#include <TopoDS_Shape.hxx>
#include <utility>
#include <vector>

#include "batten/io/geometry_types.h"

namespace batten::internal {

struct SewnFaces {
  // A solid, a shell, or a face that is left by itself; its faces, with the places in the list of
  // those they come from.
  struct Piece {
    TopoDS_Shape shape;
    std::vector<std::pair<TopoDS_Face, size_t>> faces;
  };
  std::vector<Piece> pieces;
  SewingReport report;  // but for `surfaces`
};

// Edges within the tolerance become one, and are cut where only parts of them meet. A closed shell
// is a solid, its outside where its faces' normals point; of one solid (`solid`) closed shells that
// lie in the largest are voids of it. Faces that would come out as an invalid shape are left as
// they are, and counted. Throws Standard_Failure where OpenCASCADE does.
SewnFaces SewFaces(const std::vector<TopoDS_Face>& faces, double tolerance, bool solid);

// What the pieces came to: their kinds, shared and free edges and gaps.
SewingReport ReportOf(const std::vector<SewnFaces::Piece>& pieces);

}  // namespace batten::internal
