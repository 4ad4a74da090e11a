// SPDX-License-Identifier: MIT
#include "fitting/revolution/torus_fit.h"

#include <Eigen/Geometry>
#include <cmath>
#include <variant>

#include "fitting/primitives/algebraic_fits.h"
#include "fitting/primitives/surface_minimum.h"

namespace batten::internal {

Ring FitTorus(const RevolutionSamples& round, const AxisFrame& start, ThreadPool& pool) {
  constexpr int kMostSteps = 50;
  const double unit = round.size > 0 ? round.size : 1;
  const ShapeData data{(round.nodes().places.colwise() - round.centre) / unit,
                       Eigen::VectorXd::Ones(round.count())};
  const Axis axis{(start.origin - round.centre) / unit, start.axes.col(2)};
  const SurfaceMinimum found =
      Minimised(AlgebraicTorusFit(data.points, axis), data, {}, kMostSteps, pool);
  const FittedSurface& shape = found.shape;
  Ring ring;
  ring.misfit = HUGE_VAL;
  // Of a straight profile, or one whose centre is beyond the axis, there is no tube.
  if (!(std::abs(shape.curvature) * kFarAway > 1) ||
      !(shape.axis_curvature * std::cos(shape.slope) / shape.curvature < 1)) {
    return ring;
  }
  const auto torus = std::get<TorusShape>(shape.Shape(unit, round.centre));
  if (!torus.center.allFinite() || !std::isfinite(torus.major_radius)) return ring;
  const Eigen::Vector3d before = start.axes.col(2);
  const Eigen::Vector3d along = before.dot(torus.axis) < 0 ? -torus.axis : torus.axis;
  ring.frame.origin = torus.center;
  // (Eigen's Quaternion::FromTwoVectors takes a tenth of the room's time to compile.)
  const Eigen::Vector3d turn = before.cross(along);
  const double sine = turn.norm(), angle = std::atan2(sine, before.dot(along));
  ring.frame.axes = start.axes;
  if (sine > 0)
    ring.frame.axes = Eigen::AngleAxisd(angle, turn / sine).toRotationMatrix() * start.axes;
  ring.radius = torus.major_radius;
  ring.tube = torus.minor_radius;
  ring.misfit = unit * std::sqrt(2 * found.form.cost / static_cast<double>(round.count())) /
                std::max(ring.radius, 1e-300);
  return ring;
}

}  // namespace batten::internal
