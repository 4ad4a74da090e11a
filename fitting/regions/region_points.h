// SPDX-License-Identifier: MIT
// Points with normals and neighbours, scaled to size one, as regions grow over them.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "batten/fitting/point_cloud.h"
#include "batten/geometry/thread_pool.h"

namespace batten::internal {

// Of steps and distances in units: what rounding leaves of them.
inline constexpr double kSettled = 1e-14;

inline constexpr double kFarNeighbour = 4;  // spacings about a point: beyond is another sheet

// (x − middle) / unit; lengths below are in units.
struct RegionPoints {
  Eigen::Matrix3Xd points;
  Eigen::Matrix3Xd normals;  // unit vectors without a sign; zero where there is none
  bool normals_estimated = false;
  Eigen::VectorXd turn;     // rms sine of the angles to the neighbours' normals
  std::vector<int> first;   // of the neighbours of each point; one entry more than points
  std::vector<int> around;  // neighbours, the nearest first, symmetric
  double spacing = 0, noise = 0;
  double rounding = 0;  // distances below mean nothing
  // The largest correlation of distances at neighbouring points that does not reject a shape.
  double most_trend = 0.15;
  double unit = 1;
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();

  Eigen::Index size() const { return points.cols(); }
  std::span<const int> Around(Eigen::Index k) const {
    const auto at = static_cast<std::size_t>(k);
    return {around.data() + first[at], around.data() + first[at + 1]};
  }
};

// Of distinct points; the cloud's normals where it has them, else those of planes through
// neighbours, and no less noise than that (the data's unit). Points are neighbours where either is
// among the nearest of the other. O(m log m).
RegionPoints MakeRegionPoints(const PointCloud& cloud,
                              std::uint64_t seed,
                              ThreadPool& pool,
                              double least_noise = 0);

// Some of them by themselves, so far apart: neighbours, no farther than a few spacings, and normals
// among these alone. Points of a narrow face are seen so once those of the faces beside it are
// gone.
RegionPoints PartOf(const RegionPoints& data,
                    const std::vector<int>& points,
                    double spacing,
                    ThreadPool& pool);

// At most so many of them, evenly along the list.
std::vector<int> Thinned(const std::vector<int>& points, std::size_t most);

}  // namespace batten::internal
