// SPDX-License-Identifier: MIT
#include "fitting/regions/border_curve.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "batten/fitting/interpolate_curve.h"
#include "batten/geometry/make_curve.h"
#include "fitting/core/rounding.h"

namespace batten::internal {
namespace {

// The arc through all points, counter-clockwise from the first to the last or all round.
std::optional<ExactArc> ArcThrough(const Eigen::Matrix3Xd& points, bool closed) {
  const Eigen::Index count = points.cols();
  if (count < 4) return std::nullopt;
  const Eigen::Vector3d a = points.col(0), b = points.col(count / 3) - a,
                        c = points.col(2 * count / 3) - a;
  const Eigen::Vector3d axis = b.cross(c);
  if (!(axis.norm() > 1e-6 * b.norm() * c.norm())) return std::nullopt;
  const Eigen::Vector3d center =
      a + (b.squaredNorm() * c.cross(axis) + c.squaredNorm() * axis.cross(b)) /
              (2 * axis.squaredNorm());
  const Eigen::Vector3d normal = axis.normalized();
  const double radius = (a - center).norm();
  for (const auto& p : points.colwise()) {
    const Eigen::Vector3d from = p - center;
    const double height = from.dot(normal);
    if (std::hypot(height, (from - height * normal).norm() - radius) > kRelativelyEqual) {
      return std::nullopt;
    }
  }
  const Frame frame(center, normal, a - center);
  double sweep = 2 * std::numbers::pi;
  if (!closed) {
    const Eigen::Vector3d last = points.rightCols<1>() - center;
    sweep = std::atan2(last.dot(frame.y()), last.dot(frame.x()));
    if (sweep <= 0) sweep += 2 * std::numbers::pi;
  }
  return ExactArc{frame, radius, {0, sweep}};
}

}  // namespace

bool OnSegment(const Eigen::Matrix3Xd& points) {
  const Eigen::Vector3d from = points.col(0), way = points.rightCols<1>() - from;
  const double length = way.norm();
  return std::all_of(points.colwise().begin(), points.colwise().end(), [&](const auto& p) {
    return (p - from).cross(way).norm() <= kRelativelyEqual * length;
  });
}

TrimmedSolidEdge CurveOf(const BorderEdge& edge, double scale, const Eigen::Vector3d& shift) {
  const bool closed = edge.start < 0;
  const auto moved = [&](const Eigen::Vector3d& place) -> Eigen::Vector3d {
    return scale * place + shift;
  };
  if (!closed && OnSegment(edge.points)) {
    const ExactLine line{moved(edge.points.col(0)), moved(edge.points.rightCols<1>())};
    return {MakeLine<3>(line.start, line.end), line};
  }
  if (auto arc = ArcThrough(edge.points, closed)) {
    arc->frame = Frame(moved(arc->frame.origin()), arc->frame.axis(), arc->frame.x());
    arc->radius *= scale;
    return {MakeArc(arc->frame, arc->radius, arc->angles), *arc};
  }
  Eigen::Matrix3Xd points = edge.points;
  if (closed) {
    points.conservativeResize(Eigen::NoChange, points.cols() + 1);
    points.rightCols<1>() = points.col(0);
  }
  points = (scale * points).colwise() + shift;
  return {InterpolateCurve<3>(points).curve, std::nullopt};
}

}  // namespace batten::internal
