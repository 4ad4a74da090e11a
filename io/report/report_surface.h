// SPDX-License-Identifier: MIT
// Surfaces as a report shows them: meshes and lines. Not installed.
#pragma once

#include <vector>

#include "batten/fitting/progress.h"
#include "batten/geometry/nurbs_surface.h"
#include "batten/geometry/thread_pool.h"
#include "batten/io/report_types.h"

namespace batten::internal {

struct SurfaceDrawing {
  double chord_tolerance;  // > 0
  Eigen::Index max_triangles;
  Progress progress;
};

// Everything but names and deviations, one entry a surface. The surfaces are near the origin.
std::vector<ReportSurface> DrawSurfaces(const std::vector<NurbsSurface>& surfaces,
                                        const SurfaceDrawing& drawing,
                                        ThreadPool& pool);

// The area of the triangles.
double AreaOf(const TriangleMesh& mesh);

}  // namespace batten::internal
