// SPDX-License-Identifier: MIT
// Distances of very many points from a surface of heights over a plane.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <mutex>
#include <vector>

#include "batten/fitting/point_distances.h"
#include "batten/geometry/foot_point.h"
#include "batten/geometry/surface_evaluator.h"
#include "batten/geometry/thread_pool.h"
#include "fitting/parameterization/plane_base.h"

namespace batten::internal {

// Local feet from the places below the points, of which nearly all are proved to be the nearest by
// two numbers a cell: with g the greatest slope and k the greatest curvature (norm of second
// derivatives) of the heights where the disc of radius d about a point's place in the plane
// reaches, d the distance found, the square of the distance is convex over the disc if k·d·(1 + 2g)
// < 1, and its local minimum the only one; beyond the disc all is farther. The others are sought
// over the whole surface, whose search is made when the first is met. Memory: a tenth of a
// search's.
class HeightDistances {
 public:
  // None where the surface is trimmed, rational or not one of heights over the plane's rectangle.
  static std::unique_ptr<HeightDistances> Of(const NurbsSurface& surface,
                                             const PlaneBase& plane,
                                             ThreadPool& pool);

  // As DistancesTo.
  PointDistances To(const Eigen::Matrix3Xd& points, ThreadPool& pool) const;

 private:
  HeightDistances(const NurbsSurface& surface, const PlaneBase& plane, ThreadPool& pool);

  bool SurelyNearest(const Eigen::Vector2d& place, double distance) const;
  const SurfaceFootPoints& Finder() const;

  SurfaceEvaluator evaluator_;
  PlaneBase plane_;
  Eigen::MatrixXd slopes_, curvatures_;  // of cells, v × u
  std::vector<int> cells_u_, cells_v_;   // of knot spans: the cell
  mutable std::once_flag once_;
  mutable std::unique_ptr<SurfaceFootPoints> finder_;
};

}  // namespace batten::internal
