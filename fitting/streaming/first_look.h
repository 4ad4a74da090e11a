// SPDX-License-Identifier: MIT
// What one pass over points tells.
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "batten/fitting/progress.h"
#include "fitting/streaming/point_passes.h"

namespace batten::internal {

struct FirstLook {
  double count = 0;      // of the points
  double different = 0;  // of them; an estimate where the sample is not all of them
  Eigen::Vector3d low = Eigen::Vector3d::Zero(), high = Eigen::Vector3d::Zero();  // world
  Eigen::Matrix3Xd sample;  // world, in the order of their hashes (PointSample)
};

// Passes over all points. Throws std::invalid_argument where there is none.
FirstLook TakeFirstLook(PointPasses& passes,
                        Eigen::Index sample,
                        std::uint64_t seed,
                        const Progress& progress);

}  // namespace batten::internal
