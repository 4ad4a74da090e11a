// SPDX-License-Identifier: MIT
// Layouts of quadrilaterals for solids, made from surfaces of triangles.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "batten/fitting/progress.h"
#include "batten/geometry/quad_mesh.h"

namespace batten {

// Triangles counter-clockwise seen from outside.
struct TriangleSurface {
  Eigen::Matrix3Xd vertices;
  Eigen::Matrix3Xi triangles;
};

// A closed surface made of faces that were not quite one, and what was done to them.
struct ClosedSurface {
  TriangleSurface surface;
  int joined = 0;     // vertices at the place of another
  int dropped = 0;    // faces without area, or there twice
  int turned = 0;     // faces turned round
  int filled = 0;     // holes closed
  double filled_share = 0;  // of the area
  int components = 0, genus = 0;
};

// Joins vertices at one place, cuts faces into triangles, drops those without area or twice there,
// turns faces alike and outwards, parts surfaces that touch at a vertex only, and closes holes by
// triangles about their middles. Throws RefusedData, naming it, where more than two faces meet at an
// edge, a surface has one side only, no face is left, or holes are more than `most_filled` of the
// area.
ClosedSurface CloseSurface(const Eigen::Matrix3Xd& vertices,
                           const std::vector<std::vector<int>>& faces,
                           double most_filled = 0.15);

// A layout of about `faces` quadrilaterals over a closed surface, its vertices on it: the surface
// with triangles of even size, paired over the edges by a perfect matching of greatest weight,
// which exists [Petersen 1891], and improved by turning edges until fewer vertices have other than
// four. Extraordinary vertices are many; layouts of quadrilateral remeshers have fewer. Throws
// RefusedData where no layout of the same genus comes out; Cancelled when progress stops it.
// [even triangles: Botsch & Kobbelt 2004; pairing: Remacle et al. 2012]
QuadMesh LayoutOf(const TriangleSurface& surface, int faces, const Progress& progress = {});

}  // namespace batten
