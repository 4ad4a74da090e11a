// SPDX-License-Identifier: MIT
#include "fitting/regions/made_face.h"

#include <utility>

#include "batten/fitting/fit_surface.h"
#include "batten/fitting/refused_data.h"
#include "fitting/core/fit_end.h"
#include "fitting/primitives/surface_patch.h"
#include "fitting/primitives/surface_primitive.h"

namespace batten::internal {
namespace {

MadeFace Covered(const RegionPoints& data,
                 const RegionFace& face,
                 const Eigen::Vector3d& move,
                 std::vector<std::string>& warnings,
                 ThreadPool& pool) {
  std::vector<std::string> own = face.warnings;
  MadeFace made{CoveredFace(data, face, move, own, pool), {}, face.points, {}, {}};
  const Eigen::Matrix3Xd points = data.points(Eigen::all, face.points);
  const ExactSurface local = Placed(*made.face.patch, 1, -data.middle - move);
  made.parameters = FootPointsOn(local, data.unit * points, pool);
  made.residuals = data.unit * SurfaceDistances(face.shape, points, pool);
  if (!LooksAlike(face.shape, *made.face.patch)) made.residuals *= -1;
  made.summary.kind = face.numbers.kind;
  made.summary.primitive = face.numbers;
  for (const std::string& warning : own) {
    warnings.push_back(made.summary.kind + " of " + std::to_string(face.points.size()) +
                       " points: " + warning);
  }
  return made;
}

}  // namespace

std::vector<MadeFace> ShapeFaces(const RegionPoints& data,
                                 const std::vector<RegionFace>& shapes,
                                 const Eigen::Vector3d& move,
                                 std::vector<std::string>& warnings,
                                 ThreadPool& pool) {
  std::vector<MadeFace> made;
  for (std::size_t k = 0; k < shapes.size(); ++k) {
    made.push_back(Covered(data, shapes[k], move, warnings, pool));
    made.back().shape = static_cast<int>(k);
  }
  return made;
}

std::vector<MadeFace> FreeFaces(const PointCloud& cloud,
                                std::vector<std::vector<int>> pieces,
                                const PartFitOptions& options,
                                std::vector<std::string>& warnings) {
  SurfaceFitOptions free;
  free.tolerance = options.tolerance;
  free.shift = options.shift;
  free.seed = options.seed;
  free.threads = options.threads;
  free.progress = options.progress;
  std::vector<MadeFace> made;
  for (std::vector<int>& piece : pieces) {
    const std::vector<Eigen::Index> indices(piece.begin(), piece.end());
    try {
      SurfaceFit fit = FitSurface(cloud.Picked(indices), free);
      if (fit.report.leaves_points()) {
        warnings.push_back("a free face of " + std::to_string(piece.size()) +
                           " points: " + WordsOfLeaving(fit.report));
      }
      made.push_back({{FreeForm(), std::nullopt, std::move(fit.surface)},
                      {"free"},
                      std::move(piece),
                      std::move(fit.residuals),
                      fit.parameters});
    } catch (const RefusedData& refusal) {
      warnings.push_back("a smooth region of " + std::to_string(piece.size()) +
                         " points has no face: " + refusal.what());
    }
  }
  return made;
}

}  // namespace batten::internal
