// SPDX-License-Identifier: MIT
// Layouts whose edges follow the creases of a surface.
#pragma once

#include "batten/geometry/quad_mesh.h"
#include "batten/geometry/triangle_surface.h"
#include "fitting/solid/surface_creases.h"
#include "fitting/solid/surface_projector.h"

namespace batten::internal {

// The layout with its creases laid onto those of the surface: their vertices on the curves, those
// where these have corners at the corners. Other vertices move to the middle of their faces', all
// in so many rounds.
QuadMesh OntoCreases(QuadMesh layout,
                     const TriangleSurface& surface,
                     const SurfaceCreases& creases,
                     const SurfaceProjector& projector,
                     int rounds);

inline constexpr int kEvenRounds = 12;  // that make one even

// Refuses a layout with a face that is not even, but for its caps.
void RefuseUneven(const QuadMesh& layout);

// The triangle of a surface under the middle of a face.
int TriangleUnder(const QuadMesh& layout, int face, const SurfaceProjector& projector);

// The creases of a layout near a surface: edges whose faces' middles the surface's creases part, as
// far as about the faces.
Eigen::Matrix2Xi CreasesBetweenFaces(const QuadMesh& layout,
                                     const TriangleSurface& surface,
                                     const SurfaceCreases& creases);

}  // namespace batten::internal
