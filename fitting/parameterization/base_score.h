// SPDX-License-Identifier: MIT
// How well a base serves, before the fit over it.
#pragma once

#include <vector>

#include "batten/fitting/point_cloud.h"
#include "batten/fitting/surface_options.h"
#include "batten/geometry/thread_pool.h"
#include "fitting/parameterization/parameterization.h"

namespace batten::internal {

// A sample of a cloud's points, the same for every base that is compared.
class BaseScore {
 public:
  // `kept` are indices of good points, not none. Everything else is referred to, not copied.
  BaseScore(const PointCloud& points,
            const std::vector<Eigen::Index>& kept,
            const SurfaceFitOptions& options,
            ThreadPool& pool);

  const PointMask& sample() const { return sample_; }

  struct Value {
    double score = 0;  // estimate of the mean squared distance of new points along the normal
    int cells_u = 1, cells_v = 1;  // of the grid cross-validation chose
    int control_points = 0;        // over it
  };

  // Generalised cross-validation of the best grid over the base, of the sample's points that the
  // base has a place for: the others' parameters are a guess. O(points of the sample).
  Value Of(const Parameterization& base, const PointMask& reached) const;

  // The same where nearly the same base is known to ask for nearly such a grid: only its
  // surroundings are searched.
  Value Near(const Parameterization& base, const PointMask& reached, const Value& near) const;

  // At less cost, and hardly ever too low: of a few grids with about as many cells as `near` has,
  // and of no more than so many control points.
  Value AtMost(const Parameterization& base,
               const PointMask& reached,
               const Value& near,
               double most_control_points) const;

 private:
  FittingProblem ProblemOf(const Parameterization& base, const PointMask& reached) const;
  Value At(const Parameterization& base,
           const FittingProblem& problem,
           int cells_u,
           int cells_v) const;

  const PointCloud& points_;
  const SurfaceFitOptions& options_;
  ThreadPool& pool_;
  PointMask sample_;
};

}  // namespace batten::internal
