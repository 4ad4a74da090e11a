// SPDX-License-Identifier: MIT
#include "fitting/outline/holes_in_space.h"

#include <Eigen/Geometry>

#include "geometry/editing/loop_nesting.h"

namespace batten::internal {
namespace {

constexpr int kPlacesAcross = 16;  // of a hole's box, a direction
constexpr Eigen::Index kMostNear =
    100'000;  // points about a hole so large that it is none of these

// The places of the surface at feet inside a box.
Eigen::Matrix3Xd PlacesIn(const NurbsSurface& surface,
                          const Eigen::Matrix2Xd& feet,
                          const Eigen::AlignedBox2d& box) {
  std::vector<Eigen::Index> inside;
  for (Eigen::Index k = 0; k < feet.cols(); ++k)
    if (box.contains(Eigen::Vector2d(feet.col(k)))) inside.push_back(k);
  Eigen::Matrix3Xd places(3, static_cast<Eigen::Index>(inside.size()));
  for (size_t k = 0; k < inside.size(); ++k)
    places.col(static_cast<Eigen::Index>(k)) = surface.At(feet(0, inside[k]), feet(1, inside[k]));
  return places;
}

bool IsHole(const NurbsSurface& surface,
            const Eigen::Matrix2Xd& polygon,
            const Eigen::Matrix2Xd& feet,
            double least) {
  const Eigen::AlignedBox2d box(polygon.rowwise().minCoeff(), polygon.rowwise().maxCoeff());
  const Eigen::AlignedBox2d about(box.min() - box.sizes(), box.max() + box.sizes());
  const Eigen::Matrix3Xd near = PlacesIn(surface, feet, about);
  if (near.cols() == 0 || near.cols() > kMostNear) return true;
  for (int i = 0; i < kPlacesAcross; ++i) {
    for (int j = 0; j < kPlacesAcross; ++j) {
      const Eigen::Array2d share((i + 0.5) / kPlacesAcross, (j + 0.5) / kPlacesAcross);
      const Eigen::Vector2d at = box.min() + (share * box.sizes().array()).matrix();
      if (!InsidePolygon(polygon, at)) continue;
      const Eigen::Vector3d place = surface.At(at[0], at[1]);
      if ((near.colwise() - place).colwise().squaredNorm().minCoeff() > least * least) return true;
    }
  }
  return false;
}

}  // namespace

std::vector<NurbsCurve<2>> HolesInSpace(const NurbsSurface& surface,
                                        const std::vector<NurbsCurve<2>>& loops,
                                        const Eigen::Matrix2Xd& feet,
                                        double least) {
  std::vector<NurbsCurve<2>> kept;
  for (const NurbsCurve<2>& loop : loops) {
    const Eigen::Matrix2Xd polygon = NestingPolygon(loop);
    if (PolygonArea(polygon) > 0 || IsHole(surface, polygon, feet, least)) kept.push_back(loop);
  }
  return kept;
}

}  // namespace batten::internal
