// SPDX-License-Identifier: MIT
#include "fitting/solid/solid_measurement.h"

#include <Eigen/Dense>
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

std::vector<char> CapBlocks(const std::vector<int>& caps,
                            const std::vector<BlockPlace>& places,
                            std::size_t blocks) {
  if (caps.empty()) return {};
  std::vector<char> marks(blocks, 0);
  for (const int face : caps) marks[std::size_t(places[std::size_t(face)].block)] = 1;
  return marks;
}

NearestSurfaces MeasureSolid(const SolidModel& solid,
                             const std::vector<char>& left_out,
                             const std::vector<BlockPlace>& places,
                             const LimitStencils& stencils,
                             const Eigen::Matrix3Xd& control_points,
                             const Eigen::Matrix3Xd& points,
                             ThreadPool& pool) {
  // Without regard to normals: what is reported is the distance from the solid.
  const std::vector<LimitFoot> feet = FeetOn(LimitSurface(stencils, control_points),
                                             stencils.patches(),
                                             points,
                                             Eigen::Matrix3Xd(3, 0),
                                             false,
                                             {},
                                             pool);
  NearestSurfaces nearest{std::vector<int>(feet.size()),
                          Eigen::VectorXd(points.cols()),
                          Eigen::Matrix2Xd(2, points.cols())};
  pool.For(points.cols(), 256, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (std::ptrdiff_t k = begin; k < end; ++k) {
      const LimitPlace& place = feet[std::size_t(k)].place;
      const BlockPlace& face = places[std::size_t(place.patch >> 2)];
      Eigen::Vector2d at = ParametersInBlock(face, place);
      nearest.surface[std::size_t(k)] = face.block;
      nearest.distances[k] =
          DistanceFrom(solid.faces[std::size_t(face.block)].surface, points.col(k), at);
      nearest.parameters.col(k) = at;
    }
  });
  if (left_out.empty()) return nearest;
  std::vector<NurbsSurface> kept;
  std::vector<int> number;  // of each face among those kept
  for (std::size_t f = 0; f < left_out.size(); ++f) {
    number.push_back(static_cast<int>(kept.size()));
    if (!left_out[f]) kept.push_back(solid.faces[f].surface);
  }
  std::vector<Eigen::Index> beyond;  // a border
  for (std::size_t k = 0; k < feet.size(); ++k) {
    int& face = nearest.surface[k];
    if (left_out[std::size_t(face)]) beyond.push_back(Eigen::Index(k));
    face = number[std::size_t(face)];
  }
  const NearestSurfaces of_those = NearestOf(kept, points(Eigen::all, beyond), pool);
  nearest.distances(beyond) = of_those.distances;
  nearest.parameters(Eigen::all, beyond) = of_those.parameters;
  for (std::size_t i = 0; i < beyond.size(); ++i)
    nearest.surface[std::size_t(beyond[i])] = of_those.surface[i];
  return nearest;
}

}  // namespace batten::internal
