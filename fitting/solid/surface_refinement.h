// SPDX-License-Identifier: MIT
// Finer control points where a limit surface misses its points.
#pragma once

#include <optional>
#include <vector>

#include "batten/geometry/thread_pool.h"
#include "fitting/solid/surface_fit.h"
#include "geometry/subdivision/limit_surface.h"

namespace batten::internal {

// A surface over a mesh refined once more, where all but the control points that were fitted anew
// are the coarser mesh's.
struct RefinedSurface {
  LimitStencils stencils;
  LimitSurfaceFit fit;
  std::vector<int> caps;  // faces
  Eigen::Index free = 0;  // control points fitted anew
};

// A fit whose smoothing points left out have chosen.
struct CoarseSurface {
  const LimitStencils& stencils;
  const LimitSurfaceFit& fit;
  const SurfaceData& data;
  const std::vector<int>& caps;  // faces without points
};

// On the faces with a point beyond the tolerance, or, if that is none or leads nowhere, on those of
// them whose points miss the surface by more than noise, if they have points for finer ones, and on
// those about them: the vertices of Subdivided move, all others stay what subdivision makes of
// them, so that control meshes have no T-joints. `barred`: faces that stay as they are, empty:
// none. None where there are no such faces, or points left out are not met better. [hierarchical
// Catmull-Clark surfaces: Wei, Zhang, Hughes & Scott 2015]
std::optional<RefinedSurface> RefineSurface(const CoarseSurface& coarse,
                                            const std::vector<char>& barred,
                                            std::optional<double> tolerance,
                                            const SurfaceFitSettings& settings,
                                            ThreadPool& pool);

// Bars the face nearest to a point and those about it; whether one of them was not yet.
bool BarAbout(const CoarseSurface& coarse,
              const Eigen::Vector3d& point,
              ThreadPool& pool,
              std::vector<char>& barred);

}  // namespace batten::internal
