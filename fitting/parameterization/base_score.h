// SPDX-License-Identifier: MIT
// Score of a base by generalised cross-validation, before the fit over it.
#pragma once

#include <vector>

#include "batten/fitting/point_cloud.h"
#include "batten/fitting/surface_options.h"
#include "batten/geometry/thread_pool.h"
#include "fitting/parameterization/parameterization.h"

namespace batten::internal {

// Degree of the surfaces that bases are judged by and parameters settled on: higher ones cost much
// and do not improve them.
inline constexpr int kProbeDegree = 3;

// Ratio of control points; then scores may be a little worse.
inline constexpr double kClearlyFewer = 0.8;

// Scores bases over one sample of a cloud's points, the same for every base that is compared.
class BaseScore {
 public:
  // `kept` are the indices of the inliers, at least one. All else is referred to, not copied.
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

  // Scores the base by generalised cross-validation over the best grid. Only points of the sample
  // that the base has a place for count: the others' parameters are a guess. O(points of the
  // sample).
  Value Of(const Parameterization& base, const PointMask& reached) const;

  // Scores a base similar to one scored before: only grids close to the one chosen then (`near`)
  // are searched.
  Value Near(const Parameterization& base, const PointMask& reached, const Value& near) const;

  // Estimates an upper bound of the score at less cost, hardly ever too low: from a few grids with
  // about as many cells as `near` has and at most `most_control_points` control points.
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
