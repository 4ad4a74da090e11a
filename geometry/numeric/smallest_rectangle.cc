// SPDX-License-Identifier: MIT
#include "geometry/numeric/smallest_rectangle.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace batten::internal {

namespace {

// Without points clearly inside the polygon of those farthest in eight directions. [Akl & Toussaint
// 1978]
void DropInner(std::vector<Eigen::Vector2d>& points) {
  constexpr size_t kFew = 200;
  if (points.size() < kFew) return;
  constexpr int kWays = 8;
  const Eigen::Vector2d ways[kWays] = {
      {1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}, {-1, -1}, {0, -1}, {1, -1}};
  Eigen::Vector2d farthest[kWays];
  double reach[kWays];
  std::fill(reach, reach + kWays, -std::numeric_limits<double>::infinity());
  for (const Eigen::Vector2d& p : points) {
    for (int way = 0; way < kWays; ++way) {
      const double own = ways[way].dot(p);
      if (own > reach[way]) {
        reach[way] = own;
        farthest[way] = p;
      }
    }
  }
  // Left of every side by more than rounding.
  constexpr double kClearly = 1e-9;
  Eigen::Vector2d inwards[kWays];
  double least[kWays];
  bool extended = false;
  for (int way = 0; way < kWays; ++way) {
    const Eigen::Vector2d side = farthest[(way + 1) % kWays] - farthest[way];
    inwards[way] = {-side[1], side[0]};
    const double size = inwards[way].cwiseAbs().sum() *
                        (farthest[way].cwiseAbs().sum() + std::abs(reach[0]) + std::abs(reach[4]) +
                         std::abs(reach[2]) + std::abs(reach[6]));
    least[way] = inwards[way].dot(farthest[way]) + kClearly * size;
    if (side.isZero(0)) {
      least[way] = -std::numeric_limits<double>::infinity();
    } else {
      extended = true;
    }
  }
  if (!extended) return;
  std::erase_if(points, [&](const Eigen::Vector2d& p) {
    bool inside = true;
    for (int way = 0; way < kWays; ++way) inside = inside && inwards[way].dot(p) > least[way];
    return inside;
  });
}

}  // namespace

std::vector<Eigen::Vector2d> ConvexHullOf(std::vector<Eigen::Vector2d> points) {
  DropInner(points);
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

}  // namespace batten::internal
