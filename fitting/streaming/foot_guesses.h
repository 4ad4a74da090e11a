// SPDX-License-Identifier: MIT
// Feet of many points on a surface, guessed from those of a sample.
#pragma once

#include <Eigen/Core>

#include "batten/fitting/distances.h"
#include "batten/fitting/neighbours.h"
#include "fitting/foot_points/surface_distances.h"

namespace batten::internal {

// A point's foot is sought from that of the sample's nearest point.
class FootGuesses {
 public:
  FootGuesses(const NurbsSurface& surface,
              double expected,
              const Eigen::Matrix3Xd& sample,
              ThreadPool& pool);

  // The whole distances, as DistancesTo has them.
  PointDistances DistancesOf(const Eigen::Matrix3Xd& points, ThreadPool& pool) const;

  // Those of the sample.
  const PointDistances& of_sample() const { return of_sample_; }

 private:
  NeighbourIndex index_;
  PointDistances of_sample_;
  SurfaceDistances surface_;
};

}  // namespace batten::internal
