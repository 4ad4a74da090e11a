// SPDX-License-Identifier: MIT
// Orthogonal distances and foot points of points on a curve or surface.
#pragma once

#include <Eigen/Core>
#include <string>

#include "batten/fitting/point_distances.h"
#include "batten/geometry/foot_point.h"
#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"
#include "batten/geometry/thread_pool.h"

namespace batten {

// A sentence on uncertified distances, for reports.
std::string UncertifiedText(Eigen::Index count);

// Distances from each point's nearest point on the whole surface or, where it is trimmed, on the
// part inside its loops. Where that point lies on the border, of the surface or of the part, the
// distance is the whole one, not only its share along the normal; its sign is that of the side of
// the tangent plane there on which the given point lies.
PointDistances DistancesTo(const NurbsSurface& surface,
                           const Eigen::Matrix3Xd& points,
                           ThreadPool& pool);

// The same distances, faster: column k of `near` is a guess of the foot parameters of point k, or
// NaN. Throws std::invalid_argument unless there is one column a point.
PointDistances DistancesTo(const NurbsSurface& surface,
                           const Eigen::Matrix3Xd& points,
                           const Eigen::Matrix2Xd& near,
                           ThreadPool& pool);

// Distances from the local foot points reached from given parameters, for iterations in which the
// shape moves little. Trims are ignored: a surface is fitted before it is trimmed.
PointDistances DistancesFrom(const NurbsSurface& surface,
                             const Eigen::Matrix3Xd& points,
                             const Eigen::Matrix2Xd& start,
                             ThreadPool& pool);

template <int Dim>
PointDistances DistancesTo(const NurbsCurve<Dim>& curve,
                           const Eigen::Matrix3Xd& points,
                           ThreadPool& pool) {
  const std::vector<CurveFoot> feet = CurveFootPoints<Dim>(curve).Nearest(points, pool);
  PointDistances result{Eigen::VectorXd(points.cols()), Eigen::MatrixXd(1, points.cols())};
  for (Eigen::Index k = 0; k < points.cols(); ++k) {
    result.distances[k] = feet[k].distance;
    result.parameters(0, k) = feet[k].u;
    if (!feet[k].certified) ++result.uncertified;
  }
  return result;
}

}  // namespace batten
