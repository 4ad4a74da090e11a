// SPDX-License-Identifier: MIT
// The distances of all points from a surface, measured as they pass by.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <functional>
#include <memory>
#include <optional>

#include "batten/fitting/point_source.h"
#include "batten/geometry/thread_pool.h"
#include "fitting/parameterization/parameterization.h"
#include "fitting/streaming/distance_counts.h"
#include "fitting/streaming/foot_guesses.h"
#include "fitting/streaming/height_distances.h"

namespace batten::internal {

// A surface in the sample's coordinates, and the feet of the sample on it, from which those of all
// points are sought.
class DistanceMeter {
 public:
  DistanceMeter(const NurbsSurface& surface,
                const Parameterization& base,
                double expected,
                const Eigen::Matrix3Xd& sample,
                ThreadPool& pool);

  PointDistances Of(const Eigen::Matrix3Xd& points, ThreadPool& pool) const;
  const PointDistances& of_sample() const { return of_sample_; }

 private:
  std::unique_ptr<HeightDistances> heights_;
  std::optional<PlaneBase> plane_;
  std::optional<SurfaceDistances> over_plane_;  // of what is no plain surface of heights
  std::optional<FootGuesses> guesses_;
  PointDistances of_sample_;
};

// What is told of all points in the end. Those farther off than the limit are not used.
struct AllDistances {
  AllDistances(double unit, std::optional<double> tolerance, double limit);

  // `points`: 3 × m, in world coordinates.
  void Add(const Eigen::Matrix3Xd& points, const Eigen::VectorXd& distances);
  // Adds what other processes have measured.
  void Merge(PointSource& source);

  // What Merge adds beside the counts, as numbers and from them.
  using Extremes = std::array<double, 11>;
  Extremes extremes() const;
  void set_extremes(const Extremes& extremes);

  DistanceCounts used, all;
  double limit;
  Eigen::Vector3d farthest = Eigen::Vector3d::Zero();  // of those used, world
  Eigen::AlignedBox3d beyond;                          // of the others
};

}  // namespace batten::internal
