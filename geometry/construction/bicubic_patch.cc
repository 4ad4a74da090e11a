// SPDX-License-Identifier: MIT
#include "batten/geometry/bicubic_patch.h"

#include <string>
#include <utility>

#include "geometry/construction/curve_closure.h"
#include "geometry/numeric/construction_checks.h"

namespace batten {
using namespace internal;

NurbsSurface BicubicPatch(const PatchCorners& corners) {
  Eigen::Matrix3Xd points(3, 16);
  bool apart = false;
  for (int corner = 0; corner < 4; ++corner) {
    const Eigen::Vector3d& point = corners.points[corner];
    const Eigen::Vector3d& along_u = corners.tangents_u[corner];
    const Eigen::Vector3d& along_v = corners.tangents_v[corner];
    const Eigen::Vector3d& twist = corners.twists[corner];
    const std::string number = "corner " + std::to_string(corner % 2) + std::to_string(corner / 2);
    RequireThat(
        point.allFinite() && along_u.allFinite() && along_v.allFinite() && twist.allFinite(),
        "BicubicPatch",
        "a number of " + number + " is not finite");
    apart = apart || point != corners.points[0];
    // Inward from the corner: its end of each direction, and the sign of a step there.
    const int i = corner % 2 == 0 ? 0 : 3, j = corner / 2 == 0 ? 0 : 3;
    const int inward_i = i == 0 ? 1 : 2, inward_j = j == 0 ? 1 : 2;
    const double step_u = i == 0 ? 1.0 / 3 : -1.0 / 3, step_v = j == 0 ? 1.0 / 3 : -1.0 / 3;
    points.col(4 * i + j) = point;
    points.col(4 * inward_i + j) = point + step_u * along_u;
    points.col(4 * i + inward_j) = point + step_v * along_v;
    points.col(4 * inward_i + inward_j) =
        point + (step_u * along_u + step_v * along_v + step_u * step_v * twist);
  }
  RequireThat(apart, "BicubicPatch", "all four corners are one point");
  const SplineBasis cubic = SplineBasis::Uniform(3, 4, 0, 1);
  NurbsSurface patch(cubic, cubic, std::move(points));
  RequireArea(patch, "BicubicPatch");
  return patch;
}

}  // namespace batten
