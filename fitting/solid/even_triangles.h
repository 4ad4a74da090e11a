// SPDX-License-Identifier: MIT
// A closed surface with triangles of even size.
#pragma once

#include "batten/fitting/progress.h"
#include "batten/geometry/triangle_surface.h"
#include "fitting/solid/creased_mesh.h"
#include "fitting/solid/surface_creases.h"
#include "fitting/solid/surface_projector.h"

namespace batten::internal {

// The surface with edges of about the length: longer ones split, shorter ones collapsed where the
// surface stays what it is, edges turned towards six at a vertex, vertices moved to the middle of
// their neighbours and back onto the surface. Creases stay chains of edges, their vertices on them.
// [Botsch & Kobbelt 2004]
CreasedSurface EvenTriangles(const TriangleSurface& surface,
                             const SurfaceCreases& creases,
                             const SurfaceProjector& projector,
                             double length,
                             const Progress& progress);

}  // namespace batten::internal
