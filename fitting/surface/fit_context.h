// SPDX-License-Identifier: MIT
// What every stage of a surface fit over a base looks at.
#pragma once

#include "batten/fitting/fitting_problem.h"
#include "batten/fitting/surface_options.h"
#include "batten/geometry/thread_pool.h"
#include "fitting/surface/surface_preparation.h"

namespace batten::internal {

// Prepared points over their base, with the options; all is referred to, not copied, but for the
// parameters where the base does not reach every point.
class FitContext {
 public:
  FitContext(const PreparedCloud& prepared, const SurfaceFitOptions& options, ThreadPool& pool);

  const PreparedCloud& prepared() const { return prepared_; }
  const SurfaceFitOptions& options() const { return options_; }
  ThreadPool& pool() const { return pool_; }
  const PointCloud& points() const { return prepared_.merged.cloud; }
  const Parameterization& base() const { return own_base_ ? *own_base_ : prepared_.base; }
  double spacing() const { return prepared_.statistics.spacing; }
  double noise() const { return prepared_.statistics.noise; }

  // The problem of some points over the least bases.
  FittingProblem ProblemOf(const PointMask& mask) const;

  // The problem over so many cells.
  FittingProblem WithCells(const FittingProblem& problem, int cells_u, int cells_v) const;

  // Gives points without parameters in the base those of their foot points on a surface.
  void PlaceTheRest(const NurbsSurface& surface);

  // Whether the place of point k is not on the domain's border.
  bool IsInside(Eigen::Index k) const;

 private:
  const PreparedCloud& prepared_;
  const SurfaceFitOptions& options_;
  ThreadPool& pool_;
  std::optional<Parameterization> own_base_;
};

}  // namespace batten::internal
