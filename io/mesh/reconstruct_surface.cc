// SPDX-License-Identifier: MIT
#include "batten/io/reconstruct_surface.h"

#include <dlfcn.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "batten/fitting/cloud_parts.h"
#include "batten/fitting/cloud_statistics.h"
#include "batten/fitting/neighbours.h"
#include "batten/fitting/refused_data.h"
#include "fitting/neighbours/oriented_normals.h"
#include "io/exchange/opencascade_module.h"
#include "io/mesh/poisson_functions.h"

namespace batten {
namespace internal {
namespace {

constexpr const char* kModule = "libbatten_reconstruction.so";
constexpr const char* kTable = "batten_reconstruction_functions";

const PoissonFunctions& LoadPoisson() {
  std::string reason;
  for (const std::string& folder : OpenCascadeFolders()) {
    const std::string file = (std::filesystem::path(folder) / kModule).string();
    if (void* const module = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL)) {
      if (void* const table = dlsym(module, kTable)) {
        return *reinterpret_cast<const PoissonFunctions* (*)()>(table)();
      }
    }
    const char* const said = dlerror();
    std::error_code unknown;
    if (said != nullptr && (reason.empty() || std::filesystem::exists(file, unknown)))
      reason = said;
  }
  throw std::runtime_error(
      std::string("a surface about points needs the module ") + kModule +
      ", which does not load (" + reason +
      "); it is in the package libbatten0-reconstruction, a build has it once ./scripts/start is "
      "through, and BATTEN_MODULES may name the folder that holds it");
}

const PoissonFunctions& Poisson() {
  static const PoissonFunctions& functions = LoadPoisson();
  return functions;
}

// The faces of the part with most of them.
std::vector<std::vector<int>> LargestPart(const PoissonSurface& surface) {
  std::vector<int> root(std::size_t(surface.vertices.cols()));
  for (std::size_t v = 0; v < root.size(); ++v) root[v] = int(v);
  const auto find = [&](int v) {
    while (root[std::size_t(v)] != v)
      v = root[std::size_t(v)] = root[std::size_t(root[std::size_t(v)])];
    return v;
  };
  for (const std::vector<int>& face : surface.faces) {
    for (const int v : face) root[std::size_t(find(v))] = find(face[0]);
  }
  std::vector<int> size(root.size(), 0);
  for (const std::vector<int>& face : surface.faces) ++size[std::size_t(find(face[0]))];
  const int largest = int(std::max_element(size.begin(), size.end()) - size.begin());
  std::vector<std::vector<int>> kept;
  for (const std::vector<int>& face : surface.faces) {
    if (find(face[0]) == largest) kept.push_back(face);
  }
  return kept;
}

// Whether the nearest points are all on one side of a place.
bool IsBeyond(const Eigen::Vector3d& place,
              const Eigen::Matrix3Xd& points,
              const int* nearest,
              int count) {
  constexpr double kOneSided = 0.75;  // of their distance: at a straight border 0.64
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  double far = 0;
  for (int k = 0; k < count; ++k) {
    mean += points.col(nearest[k]) - place;
    far += (points.col(nearest[k]) - place).norm();
  }
  return mean.norm() > kOneSided * far;
}

// Of the area, what lies farther than three spacings from all points, or else has on it the normals
// of none of the nearest: the other side of a sheet. Which side is the sheet's is for the greater
// part to say, so that normals may all point inwards. Tells what is beyond the points.
double InventedShare(const TriangleSurface& surface,
                     const NeighbourIndex& index,
                     const Eigen::Matrix3Xd& points,
                     const Eigen::Matrix3Xd& normals,
                     double spacing,
                     std::vector<char>& beyond) {
  constexpr double kReach = 3, kNear = 1.5;  // spacings
  const Eigen::Index count = surface.triangles.cols();
  Eigen::Matrix3Xd middles(3, count), areas(3, count);
  for (Eigen::Index t = 0; t < count; ++t) {
    const Eigen::Vector3d a = surface.vertices.col(surface.triangles(0, t));
    const Eigen::Vector3d b = surface.vertices.col(surface.triangles(1, t));
    const Eigen::Vector3d c = surface.vertices.col(surface.triangles(2, t));
    middles.col(t) = (a + b + c) / 3;
    areas.col(t) = (b - a).cross(c - a);
  }
  constexpr int kNearest = 8;  // a thin body's other wall is among them
  const std::vector<int> nearest = index.Nearest(middles, kNearest);
  double far = 0, all = 0, against = 0, along = 0;
  std::vector<int> outwards(std::size_t(count), 0);
  beyond.assign(std::size_t(count), 0);
  for (Eigen::Index t = 0; t < count; ++t) {
    const double area = areas.col(t).norm();
    all += area;
    const int* const first = &nearest[std::size_t(t * kNearest)];
    const double distance = (points.col(*first) - middles.col(t)).norm();
    beyond[std::size_t(t)] =
        distance > kNear * spacing || IsBeyond(middles.col(t), points, first, kNearest);
    int& along_normals = outwards[std::size_t(t)];
    for (int k = 0; k < kNearest; ++k) along_normals += normals.col(first[k]).dot(areas.col(t)) > 0;
    if (distance > kReach * spacing) {
      far += area;
    } else {
      if (along_normals == 0) against += area;
      if (along_normals == kNearest) along += area;
    }
  }
  const int other_side = against < along ? 0 : kNearest;
  for (std::size_t t = 0; t < outwards.size(); ++t)
    beyond[t] = beyond[t] || outwards[t] == other_side;
  return (far + std::min(against, along)) / all;
}

// Refuses points of which parts with more than one in twenty lie apart from the surface: it is
// about one body of several.
void RefuseBodiesApart(const PointCloud& cloud,
                       const TriangleSurface& surface,
                       double reach,
                       ThreadPool& pool) {
  const CloudParts found = FindCloudParts(cloud, pool);
  if (found.parts.size() < 2) return;
  const std::vector<int> nearest =
      NeighbourIndex(surface.vertices, pool).Nearest(cloud.points(), 1);
  int bodies = 1;
  double share = 0;
  for (const CloudPart& part : found.parts) {
    const auto far =
        std::count_if(part.points.begin(), part.points.end(), [&](const Eigen::Index k) {
          const auto vertex = surface.vertices.col(nearest[std::size_t(k)]);
          return (vertex - cloud.points().col(k)).norm() > reach;
        });
    if (2 * far < std::ssize(part.points)) continue;
    ++bodies;
    share += part.share;
  }
  constexpr double kDebris = 0.05;
  if (share <= kDebris) return;
  throw RefusedData("the points are " + std::to_string(bodies) +
                        " separate bodies, and a surface is made about one: take one of them",
                    Remedy::kFitPart);
}

}  // namespace
}  // namespace internal

using namespace internal;

ReconstructedSurface ReconstructSurface(const PointCloud& cloud,
                                        double most_invented,
                                        int threads) {
  ThreadPool pool(threads);
  const MergedCloud merged = MergeDuplicates(cloud);
  if (merged.cloud.size() < 50) {
    throw RefusedData("there are only " + std::to_string(merged.cloud.size()) +
                      " different points: too few for a closed surface about them");
  }
  const NeighbourIndex all(merged.cloud.points(), pool);
  const CloudStatistics statistics = MeasureCloud(merged.cloud.points(), all, {}, pool);
  const PointCloud kept =
      statistics.outlier_count > 0 ? merged.cloud.Subset(!statistics.outliers) : merged.cloud;
  const Eigen::Matrix3Xd& points = kept.points();
  const NeighbourIndex index(points, pool);
  constexpr int kNeighbours = 12;
  const bool given = kept.normals().cols() == points.cols() && !kept.normals().isZero();
  const Eigen::Matrix3Xd normals =
      given ? kept.normals() : OutwardNormals(index, points, kNeighbours);
  const Eigen::Vector3d low = points.rowwise().minCoeff(), high = points.rowwise().maxCoeff();
  const double size = (high - low).maxCoeff();
  if (!(size > 0)) throw RefusedData("the points have no extent");
  const Eigen::Vector3d middle = (low + high) / 2;
  // PCL's cube is 1.25 times the points' box.
  constexpr double kCube = 1.25;
  const int depth =
      std::clamp(int(std::lround(std::log2(kCube * size / statistics.spacing))), 4, 9);
  const PoissonSurface poisson =
      Poisson().reconstruct((points.colwise() - middle) / size, normals, depth);
  if (poisson.faces.empty()) throw RefusedData("no closed surface comes out about the points");
  const Eigen::Matrix3Xd vertices = (poisson.vertices * size).colwise() + middle;
  ReconstructedSurface result;
  // What is closed here is invented as what the reconstruction closes: both are judged below.
  result.closed = CloseSurface(vertices, LargestPart(poisson), 1.0);
  constexpr double kReach = 3;  // spacings
  const double cell = kCube * size / std::exp2(depth);
  RefuseBodiesApart(kept, result.closed.surface, kReach * std::max(cell, statistics.spacing), pool);
  result.invented_share = InventedShare(
      result.closed.surface, index, points, normals, statistics.spacing, result.beyond);
  if (result.invented_share > most_invented) {
    throw RefusedData(
        "the points do not go all round a body, or its walls are too near: " +
        std::to_string(int(std::lround(100 * result.invented_share))) +
        " % of a closed surface about them would have no points on it; batten fit surface "
        "fits sheets",
        Remedy::kLeaveOpen);
  }
  result.closed.surface.vertices.colwise() += cloud.origin();
  return result;
}

}  // namespace batten
