// SPDX-License-Identifier: MIT
#include "geometry/editing/loop_nesting.h"

#include <algorithm>
#include <cmath>

namespace batten::internal {

Eigen::Matrix2Xd NestingPolygon(const NurbsCurve<2>& curve) {
  const int cuts = 4 * (curve.basis().degree() + 1);
  std::vector<double> places;
  for (const int span : curve.basis().Spans()) {
    const double a = curve.basis().knots()[span], b = curve.basis().knots()[span + 1];
    for (int i = 0; i < cuts; ++i) places.push_back(a + (b - a) * i / cuts);
  }
  Eigen::Matrix2Xd points(2, static_cast<Eigen::Index>(places.size()));
  for (size_t i = 0; i < places.size(); ++i) {
    points.col(static_cast<Eigen::Index>(i)) = curve.At(places[i]);
  }
  return points;
}

double PolygonArea(const Eigen::Matrix2Xd& polygon) {
  double twice = 0;
  const Eigen::Vector2d center = polygon.rowwise().mean();
  for (Eigen::Index i = 0, j = polygon.cols() - 1; i < polygon.cols(); j = i++) {
    const Eigen::Vector2d a = polygon.col(j) - center, b = polygon.col(i) - center;
    twice += a.x() * b.y() - a.y() * b.x();
  }
  return twice / 2;
}

bool InsidePolygon(const Eigen::Matrix2Xd& polygon, const Eigen::Vector2d& place) {
  bool inside = false;
  for (Eigen::Index i = 0, j = polygon.cols() - 1; i < polygon.cols(); j = i++) {
    const Eigen::Vector2d a = polygon.col(j), b = polygon.col(i);
    if ((a.y() > place.y()) == (b.y() > place.y())) continue;
    const double x = a.x() + (place.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x());
    if (place.x() < x) inside = !inside;
  }
  return inside;
}

bool MostlyInside(const Eigen::Matrix2Xd& polygon, const Eigen::Matrix2Xd& outer) {
  constexpr double kOnSide = 1e-9;  // of the size
  const Eigen::Vector2d low = outer.rowwise().minCoeff(), high = outer.rowwise().maxCoeff();
  if ((polygon.rowwise().maxCoeff().array() < low.array()).any() ||
      (polygon.rowwise().minCoeff().array() > high.array()).any()) {
    return false;
  }
  const double near = kOnSide * (high - low).norm();
  Eigen::Index inside = 0, outside = 0;
  for (const auto& p : polygon.colwise()) {
    bool on_side = false;
    for (Eigen::Index i = 0, j = outer.cols() - 1; i < outer.cols(); j = i++) {
      const Eigen::Vector2d a = outer.col(j), b = outer.col(i), along = b - a, to = p - a;
      const double square = along.squaredNorm();
      const double share = square > 0 ? std::clamp(to.dot(along) / square, 0.0, 1.0) : 0;
      on_side = on_side || (to - share * along).squaredNorm() < near * near;
    }
    if (!on_side) ++(InsidePolygon(outer, p) ? inside : outside);
  }
  return inside >= outside;
}

std::vector<int> EnclosingPolygons(const std::vector<Eigen::Matrix2Xd>& polygons) {
  const auto count = static_cast<int>(polygons.size());
  std::vector<double> areas;
  for (const auto& polygon : polygons) areas.push_back(std::abs(PolygonArea(polygon)));
  std::vector<int> enclosing(polygons.size(), -1);
  for (int k = 0; k < count; ++k) {
    for (int outer = 0; outer < count; ++outer) {
      if (outer == k || !(areas[outer] > areas[k])) continue;
      if (enclosing[k] >= 0 && areas[outer] >= areas[enclosing[k]]) continue;
      if (MostlyInside(polygons[k], polygons[outer])) enclosing[k] = outer;
    }
  }
  return enclosing;
}

}  // namespace batten::internal
