// SPDX-License-Identifier: MIT
// Deviations of measured points at the vertices of surfaces' meshes.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "batten/fitting/point_cloud.h"
#include "batten/fitting/progress.h"
#include "batten/geometry/nurbs_surface.h"
#include "batten/geometry/thread_pool.h"
#include "batten/io/surface_mesh.h"

namespace batten::internal {

// Sets SurfaceMesh::deviations: every point counts at its foot on the nearest of the surfaces, as
// far as three spacings of the cloud. `meshes` are those of the surfaces, in the same order.
void AddDeviations(const std::vector<NurbsSurface>& surfaces,
                   const PointCloud& cloud,
                   std::vector<SurfaceMesh>& meshes,
                   ThreadPool& pool,
                   const Progress& progress);

}  // namespace batten::internal
