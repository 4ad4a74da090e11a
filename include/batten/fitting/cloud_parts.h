// SPDX-License-Identifier: MIT
// The connected parts of a cloud: objects of a scene, islands, what was scanned beside the part.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "batten/fitting/point_cloud.h"
#include "batten/geometry/thread_pool.h"

namespace batten {

struct CloudPart {
  std::vector<Eigen::Index> points;  // of the cloud, ascending
  Eigen::AlignedBox3d box;           // in world coordinates
  double share = 0;                  // of the cloud's points
};

struct CloudParts {
  std::vector<CloudPart> parts;  // by falling number of points
  Eigen::Index stray = 0;        // points of no part: of pieces too small to carry a surface
};

// Finds them. Points are connected where they lie in one cube of two spacings or in cubes that
// touch, and where each is among the 16 nearest of the other and nearer than five times the spacing
// around both, which may be wider than elsewhere. Pieces of fewer than 30 points, or a thousandth
// of the cloud, are stray. O(m log m). The result does not depend on the number of threads. Throws
// std::invalid_argument for a cloud without points.
CloudParts FindCloudParts(const PointCloud& cloud, ThreadPool& pool);

}  // namespace batten
