// SPDX-License-Identifier: MIT
#include "fitting/streaming/near_surface.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "batten/geometry/extend.h"
#include "fitting/core/shared_constants.h"

namespace batten::internal {
namespace {

// The surface with room beyond an edge; itself where it can't go on there.
NurbsSurface WithRoom(const NurbsSurface& surface, const SurfaceEdge& edge, double room) {
  try {
    return Extended(surface, edge, room);
  } catch (const std::invalid_argument&) {
    return surface;
  }
}

NurbsSurface WithRoomAround(NurbsSurface surface, const Parameterization& base, double room) {
  for (const bool upper : {false, true}) {
    if (!base.periodic_u && !base.sharp_edge)
      surface = WithRoom(surface, {Direction::kU, upper}, room);
    const PoleKind pole = upper ? base.poles.end : base.poles.start;
    if (!base.periodic_v && pole == PoleKind::kNone)
      surface = WithRoom(surface, {Direction::kV, upper}, room);
  }
  return surface;
}

}  // namespace

NearSurface::NearSurface(Parameterization base,
                         const NurbsSurface& surface,
                         double room,
                         double expected,
                         const Eigen::Matrix3Xd& some,
                         ThreadPool& pool)
    : base_(std::move(base)), surface_(WithRoomAround(surface.WithTrims({}), base_, room)) {
  if (!base_.plane) guesses_.emplace(surface_.surface(), expected, some, pool);
  const NurbsSurface& whole = surface_.surface();
  low_ = {whole.basis_u().lower(), whole.basis_v().lower()};
  high_ = {whole.basis_u().upper(), whole.basis_v().upper()};
}

PlacedPoints NearSurface::Place(const Eigen::Matrix3Xd& points, ThreadPool& pool) const {
  PlacedPoints placed;
  if (base_.plane) {
    PlaceOverPlane(points, pool, placed);
    return placed;
  }
  PointDistances found = guesses_->DistancesOf(points, pool);
  placed.parameters = std::move(found.parameters);
  placed.offsets = found.distances;
  placed.distances = std::move(found.distances);
  return placed;
}

void NearSurface::PlaceOverPlane(const Eigen::Matrix3Xd& points,
                                 ThreadPool& pool,
                                 PlacedPoints& placed) const {
  placed.parameters.resize(2, points.cols());
  placed.offsets.resize(points.cols());
  placed.distances.resize(points.cols());
  pool.For(points.cols(), kPointsPerTask, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    const Eigen::Index count = end - begin;
    const Eigen::Matrix3Xd local = base_.plane->ToFrame(points.middleCols(begin, count));
    const Eigen::Matrix2Xd places = local.topRows<2>();
    std::vector<SurfaceJet> jets;
    surface_.Jets(places, jets);
    const Eigen::Vector3d up = base_.plane->axes.col(2);
    for (Eigen::Index k = 0; k < count; ++k) {
      const SurfaceJet& jet = jets[static_cast<std::size_t>(k)];
      const Eigen::Vector3d normal = jet.du.cross(jet.dv);
      const double offset = up.dot(points.col(begin + k) - jet.point);
      placed.offsets[begin + k] = offset;
      placed.distances[begin + k] = offset * std::abs(normal.dot(up)) / normal.norm();
    }
    placed.parameters.middleCols(begin, count) = places;
  });
}

Parameterization NearSurface::BaseOf(const std::vector<PlaceMeans>& places, double margin) const {
  Parameterization base = base_;
  base.parameters.resize(2, static_cast<Eigen::Index>(places.size()));
  for (Eigen::Index k = 0; k < base.parameters.cols(); ++k)
    base.parameters.col(k) = places[static_cast<std::size_t>(k)].at;
  const Eigen::Vector2d least = base.parameters.rowwise().minCoeff(),
                        most = base.parameters.rowwise().maxCoeff();
  Eigen::Vector2d shift = Eigen::Vector2d::Zero(), sides(base.length_u, base.length_v);
  if (!base.periodic_u && !base.sharp_edge) {
    shift[0] = least[0] - margin;
    sides[0] = most[0] - least[0] + 2 * margin;
  }
  // Poles stay at the ends of the rectangle.
  const bool open_below = base.poles.start == PoleKind::kNone,
             open_above = base.poles.end == PoleKind::kNone;
  if (!base.periodic_v) {
    const double end = open_above ? most[1] + margin : base.length_v;
    if (open_below) shift[1] = least[1] - margin;
    sides[1] = end - shift[1];
  }
  base.MoveRectangle(shift, sides);
  base.settled_cells_u = base.settled_cells_v = 0;
  return base;
}

Eigen::Matrix3Xd NearSurface::PointsOf(const std::vector<PlaceMeans>& places) const {
  Eigen::Matrix3Xd points(3, static_cast<Eigen::Index>(places.size()));
  for (Eigen::Index k = 0; k < points.cols(); ++k) {
    const PlaceMeans& place = places[static_cast<std::size_t>(k)];
    points.col(k) = surface_.At(place.at[0], place.at[1]);
    const auto normal =
        base_.plane ? base_.plane->axes.col(2).eval()
                    : surface_.NormalAt(place.at[0], place.at[1]).value_or(Eigen::Vector3d::Zero());
    points.col(k) += place.offset * normal;
  }
  return points;
}

}  // namespace batten::internal
