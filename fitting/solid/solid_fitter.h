// SPDX-License-Identifier: MIT
// A solid over a layout: fitted as coarse as that is, then finer where it misses its points.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <utility>
#include <vector>

#include "batten/fitting/point_cloud.h"
#include "batten/fitting/solid_options.h"
#include "batten/geometry/thread_pool.h"
#include "fitting/core/stage_clock.h"
#include "fitting/solid/surface_fit.h"
#include "geometry/subdivision/limit_surface.h"
#include "geometry/subdivision/spline_faces.h"

namespace batten::internal {

// The cloud as a surface is fitted to it, in its own coordinates.
struct SolidPoints {
  SurfaceData data;
  std::vector<Eigen::Index> place;  // of every point of the cloud among those of `data`
  PointMask set_aside;              // outliers among these
  InputSummary input;
};

// A fitted surface and the solid of its faces.
struct SolidShape {
  LimitStencils stencils;
  LimitSurfaceFit surface;
  std::vector<QuadBlock> blocks;
  std::vector<int> caps;                          // faces of the mesh
  int refinements = 2;                            // of the mesh to the cells of the solid's faces
  Eigen::Index free = 0;                          // control points that were fitted
  SolidModel solid = {};                          // with caps
  SolidAudit audit = {};                          // without
  std::vector<char> no_feet = {}, left_out = {};  // by patch, by block: of caps
};

class SolidFitter {
 public:
  // Fits over the layout. Keeps references to the cloud and the options. Throws as FitSolid does.
  SolidFitter(const PointCloud& cloud, const QuadMesh& layout, const SolidFitOptions& options);

  const SolidFit& coarse() const { return fit_; }
  SolidFit Coarse() && { return std::move(fit_); }

  // With finer control points where the surface misses its points and points left out are met
  // better by them; stopped while it does so, what it has, with the termination `cancelled`.
  SolidFit Refined() &&;

 private:
  SolidShape CoarseShape(const QuadMesh& layout);
  SurfaceFitSettings Settings(const SolidShape& shape) const;
  bool Refine();
  void Finish();

  const PointCloud& cloud_;
  const SolidFitOptions& options_;
  ThreadPool pool_;
  StageClock clock_;
  double stretch_ = kStretch;
  SolidPoints points_;
  std::optional<SolidShape> shape_;
  SolidFit fit_;
};

}  // namespace batten::internal
