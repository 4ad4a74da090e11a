// SPDX-License-Identifier: MIT
#include "fitting/least_squares/residual_structure.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "batten/fitting/neighbours.h"
#include "batten/fitting/point_mask.h"
#include "fitting/cloud/double_layer_test.h"
#include "fitting/neighbours/local_quadric.h"
#include "geometry/numeric/polygon.h"

namespace batten::internal {
namespace {

constexpr Eigen::Index kPlaces = 400;
constexpr Eigen::Index kMostForLayers = 100000;
constexpr Eigen::Index kFewest = 24, kMost = 240;  // points around a place

}  // namespace

double StructuredShare(const SurfaceResiduals& given, int control_points, ThreadPool& pool) {
  const Eigen::Index m = given.residuals.size();
  if (m < 2 * kFewest) return 1;
  const auto around =
      static_cast<int>(std::clamp(m / (2 * std::max(control_points, 1)), kFewest, kMost));
  const Eigen::Matrix3Xd plan = PointsInSpace(given.parameters);
  const NeighbourIndex index(plan, pool);
  const std::vector<Eigen::Index> places = SampleIndices(m, kPlaces, given.seed);
  std::vector<double> left(places.size()), all(places.size());
  pool.For(static_cast<std::ptrdiff_t>(places.size()), 16, [&](auto begin, auto end) {
    for (auto i = begin; i < end; ++i) {
      const std::vector<int> near = index.Nearest(plan.col(places[i]), around);
      const auto count = static_cast<Eigen::Index>(near.size());
      Eigen::Matrix3Xd local(3, count);
      for (Eigen::Index j = 0; j < count; ++j) {
        local.col(j) << given.parameters.col(near[j]), given.residuals[near[j]];
      }
      all[i] = local.row(2).squaredNorm() / static_cast<double>(count);
      const LocalPlane chart{local.rowwise().mean(), Eigen::Vector3d::UnitZ()};
      left[i] = std::pow(LocalQuadric::Over(chart, local).deviation(), 2);
    }
  });
  double sum_left = 0, sum_all = 0;
  for (size_t i = 0; i < places.size(); ++i) {
    sum_left += left[i];
    sum_all += all[i];
  }
  return sum_all > 0 ? 1 - sum_left / sum_all : 0;
}

double DoubleLayerFractionOf(const SurfaceResiduals& given, ThreadPool& pool) {
  // Two sheets show in a sample of very many points.
  const std::vector<Eigen::Index> some =
      SampleIndices(given.residuals.size(), kMostForLayers, given.seed);
  Eigen::Matrix3Xd raised = PointsInSpace(given.parameters(Eigen::all, some));
  const NeighbourIndex index(raised, pool);
  raised.row(2) = given.residuals(some).transpose();
  return DoubleLayerFraction(raised, index, given.seed, pool);
}

}  // namespace batten::internal
