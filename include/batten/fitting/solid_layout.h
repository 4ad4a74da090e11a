// SPDX-License-Identifier: MIT
// Layouts of quadrilaterals for solids, made from surfaces of triangles.
#pragma once

#include <Eigen/Core>

#include "batten/fitting/progress.h"
#include "batten/geometry/quad_mesh.h"
#include "batten/geometry/triangle_surface.h"

namespace batten {

// A layout of about `faces` quadrilaterals over a closed surface, its vertices on it: the squares
// of a grid onto which the surface is mapped along the smoothest field of crosses. Extraordinary
// vertices are few: those about which the crosses have to turn, 2 to 7 % of all, more on small
// bodies with thin limbs. Squares are of one
// size, or, where one of them is farther from the surface than half an edge, smaller where it bends
// if that brings them nearer. No angle is flat, and the Euler number is the surface's. Where none
// such comes out, triangles of even size are paired, which leaves many extraordinary vertices.
// Sharp edges of the surface, longer than three faces, become creases of the layout, though not of
// one of paired triangles; so do the borders of the surface's caps, those and what lies between
// them larger than a hundredth of it, smoothed; then triangles are not paired. Throws RefusedData
// where that fails as well; Cancelled when progress stops it. O(n^1.5), a second or two on 12 000
// triangles. [crosses: Knöppel, Crane, Pinkall & Schröder 2013; map: Bommes, Zimmer & Kobbelt 2009;
// pairing: Remacle et al. 2012]
QuadMesh LayoutOf(const TriangleSurface& surface, int faces, const Progress& progress = {});

// A layout of the user's with the sharp edges of the surface near it as its creases: those edges
// that lie between faces on both sides, with their vertices moved onto them. Throws as
// CheckQuadMesh does.
QuadMesh WithCreases(const QuadMesh& layout, const TriangleSurface& surface);

// How many faces a layout has at most where nobody says: one for eight points, which are two for
// each control point of the faces refined once, 60 to 2500.
int LayoutFaces(Eigen::Index points);

}  // namespace batten
