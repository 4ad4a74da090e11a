// SPDX-License-Identifier: MIT
#include "fitting/primitives/oriented_points.h"

#include <algorithm>

#include "batten/fitting/neighbours.h"
#include "batten/fitting/point_mask.h"
#include "batten/fitting/statistics.h"
#include "geometry/numeric/dense_solvers.h"

namespace batten::internal {
namespace {

constexpr Eigen::Index kQueries = 600;  // points of the sample that get normals

// The plane fitted to the nearest `count` of a point's neighbours.
struct Surroundings {
  Eigen::Vector3d foot, normal;
  double radius, bumpiness;  // least over middle variance
};

Surroundings SurroundingsOf(const Eigen::Vector3d& p,
                            const Eigen::Matrix3Xd& points,
                            const int* neighbours,
                            int count) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
  for (int j = 0; j < count; ++j) {
    const Eigen::Vector3d from = points.col(neighbours[j]) - p;
    mean += from;
    moments += from * from.transpose();
  }
  mean /= count;
  moments = moments / count - mean * mean.transpose();
  const SymmetricEigen3 solver = EigenOf3(moments);
  Surroundings around;
  around.normal = solver.vectors.col(0);
  around.foot = p + around.normal.dot(mean) * around.normal;
  around.radius = (points.col(neighbours[count - 1]) - p).norm();
  const double middle = solver.values[1];
  around.bumpiness = middle > 0 ? std::max(0.0, solver.values[0]) / middle : 1;
  return around;
}

OrientedPoints Trusted(const std::vector<Surroundings>& all) {
  constexpr double kMost = 3, kRounding = 1e-10;  // the first: in medians
  std::vector<double> radii, bumps;
  for (const Surroundings& around : all) {
    radii.push_back(around.radius);
    bumps.push_back(around.bumpiness);
  }
  const double radius = kMost * Median(radii);
  const double bump = kMost * Median(bumps) + kRounding;
  OrientedPoints trusted{Eigen::Matrix3Xd(3, std::ssize(all)),
                         Eigen::Matrix3Xd(3, std::ssize(all))};
  Eigen::Index count = 0;
  for (const Surroundings& around : all) {
    if (around.radius > radius || around.bumpiness > bump) continue;
    trusted.points.col(count) = around.foot;
    trusted.normals.col(count++) = around.normal;
  }
  trusted.points.conservativeResize(3, count);
  trusted.normals.conservativeResize(3, count);
  return trusted;
}

}  // namespace

std::vector<OrientedPoints> OrientedSamples(const Eigen::Matrix3Xd& points,
                                            std::uint64_t seed,
                                            ThreadPool& pool) {
  constexpr int kFewest = 8, kWidest = 120;
  constexpr double kWider = 3.5, kMostPart = 3;
  const auto count = static_cast<int>(points.cols());
  std::vector<OrientedPoints> samples;
  if (count < kFewest) return samples;
  const int most = std::clamp(static_cast<int>(count / kMostPart), kFewest - 2, kWidest);
  std::vector<int> widths{most};
  while (widths.size() < 3 && widths.back() / kWider >= kFewest) {
    widths.push_back(static_cast<int>(widths.back() / kWider));
  }
  const NeighbourIndex index(points);
  const std::vector<Eigen::Index> chosen = SampleIndices(count, kQueries, seed);
  std::vector<std::vector<Surroundings>> all(widths.size(),
                                             std::vector<Surroundings>(chosen.size()));
  pool.For(std::ssize(chosen), 50, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (std::ptrdiff_t i = begin; i < end; ++i) {
      const Eigen::Vector3d p = points.col(chosen[i]);
      const std::vector<int> near = index.Nearest(p, most);
      for (size_t w = 0; w < widths.size(); ++w) {
        all[w][i] = SurroundingsOf(p, points, near.data(), widths[w]);
      }
    }
  });
  for (const auto& width : all) samples.push_back(Trusted(width));
  return samples;
}

}  // namespace batten::internal
