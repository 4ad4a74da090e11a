// SPDX-License-Identifier: MIT
#include "fitting/outline/holes_in_space.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <numeric>

#include "geometry/editing/loop_nesting.h"

namespace batten::internal {
namespace {

constexpr int kPlacesAcross = 16;  // of a hole's box, a direction
constexpr Eigen::Index kMostNear =
    100'000;  // points about a hole so large that it is none of these

// Feet sorted along u.
class SortedFeet {
 public:
  explicit SortedFeet(const Eigen::Matrix2Xd& feet) : feet_(feet), order_(feet.cols()) {
    std::iota(order_.begin(), order_.end(), Eigen::Index{0});
    std::sort(order_.begin(), order_.end(), [&](Eigen::Index a, Eigen::Index b) {
      return feet(0, a) != feet(0, b) ? feet(0, a) < feet(0, b) : a < b;
    });
  }

  // The places of the surface at feet inside a box.
  Eigen::Matrix3Xd PlacesIn(const NurbsSurface& surface, const Eigen::AlignedBox2d& box) const {
    const auto first = std::partition_point(
        order_.begin(), order_.end(), [&](Eigen::Index k) { return feet_(0, k) < box.min()[0]; });
    std::vector<Eigen::Index> inside;
    for (auto at = first; at != order_.end() && feet_(0, *at) <= box.max()[0]; ++at)
      if (feet_(1, *at) >= box.min()[1] && feet_(1, *at) <= box.max()[1]) inside.push_back(*at);
    Eigen::Matrix3Xd places(3, static_cast<Eigen::Index>(inside.size()));
    for (size_t k = 0; k < inside.size(); ++k)
      places.col(static_cast<Eigen::Index>(k)) =
          surface.At(feet_(0, inside[k]), feet_(1, inside[k]));
    return places;
  }

 private:
  const Eigen::Matrix2Xd& feet_;
  std::vector<Eigen::Index> order_;
};

bool IsHole(const NurbsSurface& surface,
            const Eigen::Matrix2Xd& polygon,
            const SortedFeet& feet,
            double least) {
  const Eigen::AlignedBox2d box(polygon.rowwise().minCoeff(), polygon.rowwise().maxCoeff());
  const Eigen::AlignedBox2d about(box.min() - box.sizes(), box.max() + box.sizes());
  const Eigen::Matrix3Xd near = feet.PlacesIn(surface, about);
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
  const SortedFeet sorted(feet);
  std::vector<NurbsCurve<2>> kept;
  for (const NurbsCurve<2>& loop : loops) {
    const Eigen::Matrix2Xd polygon = NestingPolygon(loop);
    if (PolygonArea(polygon) > 0 || IsHole(surface, polygon, sorted, least)) kept.push_back(loop);
  }
  return kept;
}

}  // namespace batten::internal
