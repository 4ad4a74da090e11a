// SPDX-License-Identifier: MIT
#include "fitting/regions/region_points.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "batten/fitting/cloud_statistics.h"
#include "batten/fitting/neighbours.h"
#include "fitting/core/rounding.h"
#include "fitting/core/unit_of.h"
#include "fitting/neighbours/normals.h"
#include "geometry/numeric/constants.h"

namespace batten::internal {
namespace {

constexpr int kNeighbours = 10;        // a ring about a point
constexpr int kNormalNeighbours = 16;  // two rings: noise of normals halves against one

// The pairs of points that are neighbours, both ways, each point's nearest first; none farther than
// `farthest`.
void LinkNeighbours(const NeighbourIndex& index, double farthest, RegionPoints& data) {
  const auto count = static_cast<int>(data.size());
  const int k = std::min(kNeighbours + 1, count);
  const std::vector<int> nearest = index.Nearest(data.points, k);
  std::vector<std::vector<std::pair<double, int>>> links(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    const auto at = [&](int j) { return nearest[static_cast<std::size_t>(i) * k + j]; };
    const double usual = (data.points.col(at(k / 2)) - data.points.col(i)).norm();
    for (int j = 0; j < k; ++j) {
      const int other = at(j);
      const double far = (data.points.col(other) - data.points.col(i)).norm();
      if (other == i || !(far <= std::min(kFarNeighbour * usual, farthest))) continue;
      links[static_cast<std::size_t>(i)].emplace_back(far, other);
      links[static_cast<std::size_t>(other)].emplace_back(far, i);
    }
  }
  data.first.push_back(0);
  for (auto& link : links) {
    std::sort(link.begin(), link.end());
    link.erase(std::unique(link.begin(), link.end()), link.end());
    for (const auto& [far, other] : link) data.around.push_back(other);
    data.first.push_back(static_cast<int>(data.around.size()));
  }
}

void TakeTurns(RegionPoints& data) {
  data.turn.resize(data.size());
  for (Eigen::Index k = 0; k < data.size(); ++k) {
    double sum = 0;
    const auto around = data.Around(k);
    for (const int other : around) {
      sum += data.normals.col(k).cross(data.normals.col(other)).squaredNorm();
    }
    const bool known = !around.empty() && !data.normals.col(k).isZero(0);
    data.turn[k] = known ? std::sqrt(sum / static_cast<double>(around.size())) : 1;
  }
}

}  // namespace

RegionPoints MakeRegionPoints(const PointCloud& cloud,
                              std::uint64_t seed,
                              ThreadPool& pool,
                              double least_noise) {
  RegionPoints data;
  const Eigen::Matrix3Xd& points = cloud.points();
  data.unit = UnitOf(points);
  data.middle = (points.rowwise().minCoeff() + points.rowwise().maxCoeff()) / 2;
  data.points = (points.colwise() - data.middle) / data.unit;
  const double farthest = (cloud.origin().cwiseAbs() + data.middle.cwiseAbs()).maxCoeff();
  // Coordinates are rounded where they are read. Faces that CAD systems take for one, 1e-7 mm apart
  // over some 100 mm, are one.
  data.rounding = std::max(kRelativelyEqual, 4 * kEpsilon * farthest / data.unit);
  const NeighbourIndex index(data.points, pool);
  LinkNeighbours(index, std::numeric_limits<double>::infinity(), data);
  const CloudStatistics statistics =
      MeasureCloud(data.points, index, {.seed = seed, .find_outliers = false}, pool);
  data.spacing = statistics.spacing;
  data.noise = std::max({statistics.noise, data.rounding, least_noise / data.unit});
  if (cloud.normals().cols() == cloud.size() && !cloud.normals().isZero(0)) {
    data.normals = cloud.normals();
    for (auto normal : data.normals.colwise()) normal.stableNormalize();
  } else {
    data.normals = EstimateNormals(index, data.points, data.points, kNormalNeighbours);
    data.normals_estimated = true;
  }
  TakeTurns(data);
  return data;
}

// Without noise, unit and middle, which only the whole has.
RegionPoints PartOf(const RegionPoints& data,
                    const std::vector<int>& points,
                    double spacing,
                    ThreadPool& pool) {
  RegionPoints part;
  part.points = data.points(Eigen::all, points);
  part.spacing = spacing;
  part.rounding = data.rounding;
  part.most_trend = data.most_trend;
  part.normals_estimated = true;
  const NeighbourIndex index(part.points, pool);
  LinkNeighbours(index, kFarNeighbour * spacing, part);
  part.normals = EstimateNormals(index, part.points, part.points, kNormalNeighbours);
  TakeTurns(part);
  return part;
}

std::vector<int> Thinned(const std::vector<int>& points, std::size_t most) {
  if (points.size() <= most) return points;
  std::vector<int> some;
  some.reserve(most);
  for (std::size_t k = 0; k < most; ++k) some.push_back(points[k * points.size() / most]);
  return some;
}

}  // namespace batten::internal
