// SPDX-License-Identifier: MIT
#include "fitting/solid/surface_projector.h"
#include "geometry/mesh/triangle_measure.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <utility>

namespace batten::internal {

Eigen::Vector3d NearestOnTriangle(const TriangleSurface& surface, int t, const Eigen::Vector3d& p) {
  const auto corner = surface.triangles.col(t);
  const Eigen::Vector3d a = surface.vertices.col(corner[0]), b = surface.vertices.col(corner[1]),
                        c = surface.vertices.col(corner[2]);
  // The seven regions by signs of projections. [Ericson 2005, §5.1.5]
  const Eigen::Vector3d ab = b - a, ac = c - a, ap = p - a;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return a;
  const Eigen::Vector3d bp = p - b;
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) return b;
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return a + d1 / (d1 - d3) * ab;
  const Eigen::Vector3d cp = p - c;
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) return c;
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return a + d2 / (d2 - d6) * ac;
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    return b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b);
  }
  const double scale = 1 / (va + vb + vc);
  return a + vb * scale * ab + vc * scale * ac;
}

SurfaceProjector::SurfaceProjector(const TriangleSurface& surface)
    : surface_(surface), around_(std::size_t(surface.vertices.cols())), index_(surface.vertices) {
  for (int t = 0; t < surface.triangles.cols(); ++t) {
    for (const int v : surface.triangles.col(t)) around_[std::size_t(v)].push_back(t);
  }
}

Eigen::Vector3d SurfaceProjector::Nearest(const Eigen::Vector3d& p) const {
  constexpr int kVertices = 4;
  Eigen::Vector3d best = p;
  double least = std::numeric_limits<double>::infinity();
  const int count = int(std::min<Eigen::Index>(kVertices, surface_.vertices.cols()));
  for (const int v : index_.Nearest(p, count)) {
    for (const int t : around_[std::size_t(v)]) {
      const Eigen::Vector3d place = NearestOnTriangle(surface_, t, p);
      const double square = (place - p).squaredNorm();
      if (square >= least) continue;
      least = square;
      best = place;
    }
  }
  return best;
}

int SurfaceProjector::TriangleNear(const Eigen::Vector3d& p,
                                   const Eigen::Vector3d& direction) const {
  constexpr int kVertices = 12;
  const int count = int(std::min<Eigen::Index>(kVertices, surface_.vertices.cols()));
  int best = -1;
  std::pair<bool, double> least = {true, std::numeric_limits<double>::infinity()};
  for (const int v : index_.Nearest(p, count)) {
    for (const int t : around_[std::size_t(v)]) {
      const std::pair<bool, double> its = {!(NormalOf(surface_, t).dot(direction) > 0),
                                           (NearestOnTriangle(surface_, t, p) - p).norm()};
      if (best >= 0 && its >= least) continue;
      least = its;
      best = t;
    }
  }
  return best;
}

}  // namespace batten::internal
