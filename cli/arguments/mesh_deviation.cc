// SPDX-License-Identifier: MIT
#include "cli/arguments/mesh_deviation.h"

#include <cmath>

#include "batten/fitting/cloud_statistics.h"
#include "batten/fitting/deviation_map.h"
#include "batten/fitting/distances.h"
#include "batten/geometry/surface_evaluator.h"
#include "fitting/cloud/local_outlier_factor.h"

namespace batten::internal {
namespace {

double SpacingOf(const PointCloud& cloud, ThreadPool& pool) {
  CloudStatisticsOptions options;
  options.find_outliers = false;
  const MergedCloud merged = MergeDuplicates(cloud);
  const NeighbourIndex index(merged.cloud.points(), pool);
  return MeasureCloud(merged.cloud.points(), index, options, pool).spacing;
}

}  // namespace

void AddDeviations(const std::vector<NurbsSurface>& surfaces,
                   const PointCloud& cloud,
                   std::vector<SurfaceMesh>& meshes,
                   ThreadPool& pool,
                   const Progress& progress) {
  constexpr double kSpacings = 3;
  const auto count = static_cast<double>(surfaces.size());
  Eigen::VectorXd nearest;
  Eigen::Matrix3Xd feet(3, cloud.size());
  Eigen::VectorXi owner = Eigen::VectorXi::Zero(cloud.size());
  for (std::size_t s = 0; s < surfaces.size(); ++s) {
    Report(progress, "project", static_cast<double>(s) / count);
    const NurbsSurface surface = surfaces[s].Translated(-cloud.origin());
    const PointDistances found = DistancesTo(surface, cloud.points(), pool);
    Eigen::Matrix3Xd here;
    SurfaceEvaluator(surface).Points(found.parameters, here, pool);
    if (s == 0) {
      nearest = found.distances;
      feet = std::move(here);
      continue;
    }
    for (Eigen::Index k = 0; k < cloud.size(); ++k) {
      if (std::abs(found.distances[k]) >= std::abs(nearest[k])) continue;
      nearest[k] = found.distances[k];
      feet.col(k) = here.col(k);
      owner[k] = static_cast<int>(s);
    }
  }
  double reach = kSpacings * SpacingOf(cloud, pool);
  // A single point has no spacing: it counts everywhere.
  if (!(reach > 0)) reach = std::numeric_limits<double>::max();
  for (std::size_t s = 0; s < surfaces.size(); ++s) {
    Report(progress, "colour", static_cast<double>(s) / count);
    std::vector<Eigen::Index> own;
    for (Eigen::Index k = 0; k < cloud.size(); ++k) {
      if (owner[k] == static_cast<int>(s)) own.push_back(k);
    }
    meshes[s].deviations = DeviationMap(meshes[s].mesh.vertices.colwise() - cloud.origin(),
                                        feet(Eigen::all, own),
                                        nearest(own),
                                        reach,
                                        pool);
  }
}

}  // namespace batten::internal
