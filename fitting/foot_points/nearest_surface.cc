// SPDX-License-Identifier: MIT
#include "fitting/foot_points/nearest_surface.h"

#include <Eigen/Geometry>
#include <cmath>
#include <limits>

#include "batten/fitting/distances.h"

namespace batten::internal {

NearestSurfaces NearestOf(const std::vector<NurbsSurface>& surfaces,
                          const Eigen::Matrix3Xd& points,
                          ThreadPool& pool) {
  const Eigen::Index count = points.cols();
  NearestSurfaces nearest{std::vector<int>(std::size_t(count), -1),
                          Eigen::VectorXd::Constant(count, std::numeric_limits<double>::infinity()),
                          Eigen::Matrix2Xd::Zero(2, count)};
  for (std::size_t s = 0; s < surfaces.size(); ++s) {
    const Eigen::Matrix3Xd& net = surfaces[s].control_points();
    const Eigen::AlignedBox3d box(net.rowwise().minCoeff(), net.rowwise().maxCoeff());
    std::vector<Eigen::Index> near;
    for (Eigen::Index k = 0; k < count; ++k) {
      if (box.exteriorDistance(points.col(k)) < std::abs(nearest.distances[k])) near.push_back(k);
    }
    if (near.empty()) continue;
    const PointDistances found = DistancesTo(surfaces[s], points(Eigen::all, near), pool);
    for (Eigen::Index i = 0; i < std::ssize(near); ++i) {
      const Eigen::Index k = near[std::size_t(i)];
      if (!(std::abs(found.distances[i]) < std::abs(nearest.distances[k]))) continue;
      nearest.surface[std::size_t(k)] = static_cast<int>(s);
      nearest.distances[k] = found.distances[i];
      nearest.parameters.col(k) = found.parameters.col(i);
    }
  }
  return nearest;
}

}  // namespace batten::internal
