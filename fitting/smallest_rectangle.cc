// SPDX-License-Identifier: MIT
#include "batten/fitting/smallest_rectangle.h"

#include <algorithm>

namespace batten {

std::vector<Eigen::Vector2d> ConvexHullOf(std::vector<Eigen::Vector2d> points) {
  std::sort(points.begin(), points.end(), [](const auto& a, const auto& b) {
    return a[0] != b[0] ? a[0] < b[0] : a[1] < b[1];
  });
  points.erase(std::unique(points.begin(), points.end()), points.end());
  if (points.size() < 3) return points;
  const auto turn =
      [](const Eigen::Vector2d& o, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
        return (a - o)[0] * (b - o)[1] - (a - o)[1] * (b - o)[0];
      };
  std::vector<Eigen::Vector2d> hull;
  for (int chain = 0; chain < 2; ++chain) {
    const size_t fixed = hull.size() + 1;
    for (const Eigen::Vector2d& p : points) {
      while (hull.size() > fixed && turn(hull[hull.size() - 2], hull.back(), p) <= 0) {
        hull.pop_back();
      }
      hull.push_back(p);
    }
    hull.pop_back();
    std::reverse(points.begin(), points.end());
  }
  return hull;
}

TurnedRectangle RectangleAlong(const std::vector<Eigen::Vector2d>& hull,
                               const Eigen::Vector2d& axis) {
  TurnedRectangle turned;
  turned.axis = axis;
  turned.low.setConstant(std::numeric_limits<double>::infinity());
  turned.high = -turned.low;
  for (const Eigen::Vector2d& p : hull) {
    const Eigen::Vector2d q = turned.ToFrame(p);
    turned.low = turned.low.cwiseMin(q);
    turned.high = turned.high.cwiseMax(q);
  }
  turned.area = (turned.high - turned.low).prod();
  return turned;
}

TurnedRectangle SmallestRectangleAround(const std::vector<Eigen::Vector2d>& hull) {
  TurnedRectangle best;
  for (size_t i = 0; i < hull.size(); ++i) {
    const Eigen::Vector2d side = hull[(i + 1) % hull.size()] - hull[i];
    if (!(side.norm() > 0)) continue;
    const TurnedRectangle turned = RectangleAlong(hull, side.normalized());
    if (turned.area < best.area) best = turned;
  }
  return best;
}

}  // namespace batten
