// SPDX-License-Identifier: MIT
// Distances of many points from one surface, asked for in several calls.
#pragma once

#include <optional>

#include "batten/fitting/point_distances.h"
#include "batten/geometry/foot_point.h"
#include "batten/geometry/surface_evaluator.h"

namespace batten::internal {

// The distance of a point from its foot, with the side of the surface the point is on.
double SignedDistance(const SurfaceEvaluator& surface,
                      const Eigen::Vector3d& q,
                      const SurfaceFoot& foot);

// What DistancesTo needs of a surface, made once. Feet are local ones first, from the guesses;
// where the surface bends too much for their proof (CaptureRadius), many points are worth cutting
// its cells: a cell cut into c × c has a reach up to c times as far, for the cost of some eight
// searches a piece.
class SurfaceDistances {
 public:
  // `some` of about `expected` points in all, with guesses of their feet or NaN, say how many of
  // them have no proof with cells as they are.
  SurfaceDistances(const NurbsSurface& surface,
                   double expected,
                   const Eigen::Matrix3Xd& some,
                   const Eigen::Matrix2Xd& near,
                   ThreadPool& pool);

  // As DistancesTo(surface, points, near, pool).
  PointDistances To(const Eigen::Matrix3Xd& points,
                    const Eigen::Matrix2Xd& near,
                    ThreadPool& pool) const;

 private:
  bool SurelyNearest(const Eigen::Vector3d& q, double u, double v) const {
    return (fine_ ? *fine_ : finder_).SurelyNearest(q, u, v);
  }
  double ShareWithoutProof(const Eigen::Matrix3Xd& some,
                           const Eigen::Matrix2Xd& near,
                           ThreadPool& pool) const;

  SurfaceEvaluator evaluator_;
  SurfaceFootPoints finder_;
  std::optional<SurfaceFootPoints> fine_;  // of the surface over cut cells
};

}  // namespace batten::internal
