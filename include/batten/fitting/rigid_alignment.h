// SPDX-License-Identifier: MIT
// Rigid motions that bring measured points onto a nominal geometry.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "batten/fitting/point_cloud.h"
#include "batten/geometry/nurbs_surface.h"
#include "batten/geometry/thread_pool.h"

namespace batten {

struct RigidAlignment {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();  // of world coordinates: x ↦ R x + t
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();
  double rms_before = 0, rms_after = 0;  // distances of the points that count
  int iterations = 0;
  int determined = 0;  // of the six freedoms, those that the points determine; others stay
  // Covariance of the motion about the middle of the points, (rotation, translation), for points of
  // unit variance; zero in what is not determined.
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();  // in world coordinates, after the motion

  PointCloud Moved(const PointCloud& cloud) const;
  // The covariance of where the motion brings a place (world, after it), for points of unit
  // variance.
  Eigen::Matrix3d CovarianceAt(const Eigen::Vector3d& place) const;
};

// The motion of least Σ d², d the distances from the nearest surface: Gauss–Newton steps on the
// distances along normals [Chen & Medioni 1992], from where the points lie, which must be nearer
// than the features are to each other. Freedoms that the distances do not see, as turns about a
// cylinder's axis, are left alone. With `datums`, indices of surfaces in their order: points
// nearest to the first determine what they can, those of the second what is left, and so on, each
// by least squares; other points do not count. Throws std::invalid_argument without surfaces, for a
// datum that is none of them, or one that no point is nearest to.
RigidAlignment AlignRigidly(const std::vector<NurbsSurface>& surfaces,
                            const PointCloud& cloud,
                            const std::vector<int>& datums,
                            ThreadPool& pool);

// The standard deviation of the distance of every point (moved already) by noise of that deviation,
// and by what it does to the motion, in the direction in which that is most: for CheckProfile.
Eigen::VectorXd DistanceDeviations(const PointCloud& moved,
                                   double noise,
                                   const std::optional<RigidAlignment>& alignment);

}  // namespace batten
