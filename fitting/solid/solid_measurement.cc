// SPDX-License-Identifier: MIT
#include "fitting/solid/solid_measurement.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "fitting/solid/surface_feet.h"

namespace batten::internal {
namespace {

// Signed along the normal, from the foot that Newton's method finds from parameters near it. Near
// extraordinary vertices faces run through space a little differently than the limit surface.
double DistanceFrom(const NurbsSurface& surface, const Eigen::Vector3d& q, Eigen::Vector2d& at) {
  const Eigen::Vector2d low(surface.basis_u().lower(), surface.basis_v().lower());
  const Eigen::Vector2d high(surface.basis_u().upper(), surface.basis_v().upper());
  SurfaceJet jet = surface.JetAt(at[0], at[1]);
  for (int step = 0; step < 5; ++step) {
    const Eigen::Vector3d d = q - jet.point;
    Eigen::Matrix2d metric;
    metric << jet.du.squaredNorm(), jet.du.dot(jet.dv), jet.du.dot(jet.dv), jet.dv.squaredNorm();
    const Eigen::Vector2d move = metric.inverse() * Eigen::Vector2d(jet.du.dot(d), jet.dv.dot(d));
    if (!move.allFinite()) break;
    const Eigen::Vector2d next = (at + move).cwiseMax(low).cwiseMin(high);
    const SurfaceJet there = surface.JetAt(next[0], next[1]);
    if (!((there.point - q).norm() < d.norm())) break;
    at = next;
    jet = there;
  }
  const Eigen::Vector3d d = q - jet.point;
  return std::copysign(d.norm(), d.dot(jet.du.cross(jet.dv)));
}

}  // namespace

std::vector<char> PatchesOf(const std::vector<int>& faces, int patches) {
  if (faces.empty()) return {};
  std::vector<char> marks(std::size_t(patches), 0);
  for (const int face : faces) std::fill_n(marks.begin() + 4 * face, 4, 1);
  return marks;
}

std::vector<char> CapBlocks(const std::vector<int>& caps,
                            const std::vector<BlockPlace>& places,
                            std::size_t blocks) {
  if (caps.empty()) return {};
  std::vector<char> marks(blocks, 0);
  for (const int face : caps) marks[std::size_t(places[std::size_t(face)].block)] = 1;
  return marks;
}

NearestSurfaces MeasureSolid(const SolidModel& solid,
                             const std::vector<BlockPlace>& places,
                             int refinements,
                             const FootGround& ground,
                             const std::vector<char>& left_out,
                             const Eigen::Matrix3Xd& points,
                             ThreadPool& pool) {
  std::vector<int> number;  // of each face among those kept
  int kept = 0;
  for (std::size_t f = 0; f < solid.faces.size(); ++f) {
    number.push_back(kept);
    kept += left_out.empty() || !left_out[f];
  }
  // Without regard to normals: what is reported is the distance from the solid.
  const std::vector<LimitFoot> feet =
      FeetOn(ground, points, Eigen::Matrix3Xd(3, 0), false, {}, pool);
  NearestSurfaces nearest{std::vector<int>(feet.size()),
                          Eigen::VectorXd(points.cols()),
                          Eigen::Matrix2Xd(2, points.cols())};
  pool.For(points.cols(), 256, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (std::ptrdiff_t k = begin; k < end; ++k) {
      const LimitPlace& place = feet[std::size_t(k)].place;
      const BlockPlace& face = places[std::size_t(place.patch >> 2)];
      Eigen::Vector2d at = ParametersInBlock(face, place, refinements);
      nearest.surface[std::size_t(k)] = number[std::size_t(face.block)];
      nearest.distances[k] =
          DistanceFrom(solid.faces[std::size_t(face.block)].surface, points.col(k), at);
      nearest.parameters.col(k) = at;
    }
  });
  return nearest;
}

}  // namespace batten::internal
