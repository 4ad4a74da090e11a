// SPDX-License-Identifier: MIT
#include "geometry/construction/curve_closure.h"

#include <optional>
#include <string>

#include "batten/geometry/clamp.h"
#include "batten/geometry/closure.h"
#include "batten/geometry/join.h"
#include "batten/geometry/split.h"
#include "geometry/numeric/box_diagonal.h"
#include "geometry/numeric/constants.h"
#include "geometry/numeric/construction_checks.h"

namespace batten::internal {
namespace {

double EndGap(const NurbsCurve<3>& curve) {
  return (curve.At(curve.basis().upper()) - curve.At(curve.basis().lower())).norm();
}

}  // namespace

bool IsPoint(const NurbsCurve<3>& curve) {
  return BoxDiagonal(curve.control_points()) <=
         8 * kEpsilon * curve.control_points().cwiseAbs().maxCoeff();
}

bool LieAlong(const Eigen::Matrix3Xd& points, const Eigen::Vector3d& direction) {
  constexpr double kFlat = 1e-9;
  const Eigen::Matrix3Xd from = points.colwise() - points.col(0);
  const Eigen::Vector3d along = direction.stableNormalized();
  const double off = (from - along * (along.transpose() * from)).colwise().norm().maxCoeff();
  return off <=
         kFlat * from.colwise().norm().maxCoeff() + 8 * kEpsilon * points.cwiseAbs().maxCoeff();
}

void RequireArea(const NurbsSurface& surface, const char* function) {
  const Eigen::Matrix3Xd& net = surface.control_points();
  Eigen::Index farthest = 0;
  (net.colwise() - net.col(0)).colwise().squaredNorm().maxCoeff(&farthest);
  RequireThat(!LieAlong(net, net.col(farthest) - net.col(0)),
              function,
              "all that it is made of lies on one line: the surface would have no area");
}

void RequireSameClosedness(const std::vector<NurbsCurve<3>>& curves,
                           const char* function,
                           const char* noun) {
  const auto number = [&](std::size_t k) { return noun + (" " + std::to_string(k + 1)); };
  std::optional<std::size_t> open, closed;
  for (std::size_t k = 0; k < curves.size(); ++k) {
    if (IsPoint(curves[k])) continue;
    std::optional<std::size_t>& kind = Closed(curves[k]) ? closed : open;
    if (!kind) kind = k;
  }
  if (!open || !closed) return;
  RequireThat(false,
              function,
              number(*closed) + " is closed and " + number(*open) + " is open, its ends " +
                  RoundedText(EndGap(curves[*open])) + " apart: all are to be closed, or all open");
}

NurbsCurve<3> BegunAt(const NurbsCurve<3>& closed, double at) {
  const Eigen::VectorXd& weights = closed.weights();
  const double tolerance = kCloses * BoxDiagonal(closed.control_points());
  if (closed.basis().periodic() || weights[0] == weights[weights.size() - 1]) {
    const NurbsCurve<3> periodic = Periodic(closed, tolerance);
    return Segment(periodic, at, at + (periodic.basis().upper() - periodic.basis().lower()));
  }
  const auto [before, after] = Split(closed, at);
  return Join(after, before, tolerance);
}

}  // namespace batten::internal
