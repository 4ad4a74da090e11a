// SPDX-License-Identifier: MIT
#include "fitting/constraints/domain_box.h"

#include <string>

#include "batten/fitting/refused_data.h"
#include "fitting/core/rounding.h"
#include "fitting/core/shared_constants.h"
#include "geometry/numeric/number_text.h"

namespace batten::internal {
namespace {

// Turns the plane's axes to the coordinate axes where its normal is one of them, so that the box is
// one of coordinates.
void TurnToCoordinates(Parameterization& base) {
  PlaneBase& plane = *base.plane;
  Eigen::Index along = 0;
  if (plane.axes.col(2).cwiseAbs().maxCoeff(&along) < 1) return;
  Eigen::Matrix3d axes = Eigen::Matrix3d::Zero();
  const bool up = plane.axes(along, 2) > 0;
  axes((along + (up ? 1 : 2)) % 3, 0) = axes((along + (up ? 2 : 1)) % 3, 1) = 1;
  axes.col(2) = plane.axes.col(2);
  base.parameters = (axes.leftCols<2>().transpose() * plane.axes.leftCols<2>()) * base.parameters;
  plane.axes = axes;
}

}  // namespace

void TakeDomain(Parameterization& base,
                PointMask& reached,
                const Eigen::Vector3d& origin,
                const DomainBox& box) {
  if (base.periodic_u || base.periodic_v || base.poles.any()) {
    throw RefusedData(
        "a domain is for open surfaces; these points lie on one that closes "
        "(" +
        base.name + ")");
  }
  Eigen::Vector2d corner(0, 0);  // of the base's rectangle in the box's coordinates
  if (base.plane) TurnToCoordinates(base);
  if (base.plane)
    corner = base.plane->axes.leftCols<2>().transpose() * (origin + base.plane->origin);
  const Eigen::Vector2d old(base.length_u, base.length_v);
  const Eigen::Vector2d low(box.u0, box.v0), sides(box.u1 - box.u0, box.v1 - box.v0);
  const Eigen::Vector2d shift = low - corner;
  base.MoveRectangle(shift, sides);
  for (Eigen::Index k = 0; k < reached.size(); ++k) {
    auto place = base.parameters.col(k);
    const Eigen::Vector2d inside = place.cwiseMax(0.0).cwiseMin(sides);
    // Points on the box's edge count.
    if (((place - inside).array().abs() > kRelativeRounding * sides.array()).any())
      reached[k] = false;
    place = inside;
  }
  if (reached.count() >= kFewestSurfacePoints) return;
  throw RefusedData("the domain holds " + std::to_string(reached.count()) +
                    " points; over this base they lie in [" + NumberText(corner[0]) + ", " +
                    NumberText(corner[0] + old[0]) + "] × [" + NumberText(corner[1]) + ", " +
                    NumberText(corner[1] + old[1]) + "]");
}

}  // namespace batten::internal
