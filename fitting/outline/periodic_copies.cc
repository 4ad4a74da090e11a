// SPDX-License-Identifier: MIT
#include "fitting/outline/periodic_copies.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "geometry/editing/loop_nesting.h"

namespace batten::internal {
namespace {

constexpr double kAcross = 30;  // how far beyond a seam
constexpr double kNearPole = 2.5;

using Places = std::vector<Eigen::Vector2d>;

// A point fills the more of its row the nearer a pole is, at distances of one.
void FillRows(const Eigen::Vector2d& sides, const OutlineOptions& options, Places& places) {
  const size_t count = places.size();
  for (size_t k = 0; k < count; ++k) {
    const Eigen::Vector2d point = places[k];
    const double stretch = options.stretch_u(point.y() * options.spacing);
    if (!(stretch < 0.5)) continue;
    const double half = std::min(stretch > 0 ? 0.5 / stretch : sides[0], sides[0] / 2);
    for (double away = 1; away <= half; ++away) {
      for (const double u : {point.x() - away, point.x() + away}) {
        const double round = options.periodic_u ? u - sides[0] * std::floor(u / sides[0]) : u;
        if (round >= 0 && round <= sides[0]) places.emplace_back(round, point.y());
      }
    }
  }
}

void FillPole(double v, double width, Places& places) {
  const bool near = std::any_of(places.begin(), places.end(), [&](const Eigen::Vector2d& place) {
    return std::abs(place.y() - v) < kNearPole;
  });
  if (!near) return;
  const auto count = static_cast<int>(std::ceil(width));
  for (const double row : {v, v > 0 ? v - 1 : v + 1})
    for (int i = 0; i <= count; ++i) places.emplace_back(width * i / count, row);
}

void Repeat(int axis, double period, Places& places) {
  const size_t count = places.size();
  for (size_t k = 0; k < count; ++k) {
    const Eigen::Vector2d point = places[k], step = period * Eigen::Vector2d::Unit(axis);
    if (point[axis] < kAcross) places.push_back(point + step);
    if (point[axis] > period - kAcross) places.push_back(point - step);
  }
}

}  // namespace

double AreaInSpace(const Eigen::Matrix2Xd& polygon, const OutlineOptions& options) {
  if (!options.stretch_u) return PolygonArea(polygon);
  double sum = 0;
  for (Eigen::Index i = 0, n = polygon.cols(); i < n; ++i) {
    const Eigen::Vector2d a = polygon.col(i), b = polygon.col((i + 1) % n), middle = (a + b) / 2;
    const auto value = [&](const Eigen::Vector2d& p) {
      return p.x() * options.stretch_u(p.y() * options.spacing);
    };
    sum += (b.y() - a.y()) * (value(a) + 4 * value(middle) + value(b)) / 6;
  }
  return sum;
}

Eigen::Matrix2Xd WithPeriodicCopies(const Eigen::Matrix2Xd& points,
                                    const Eigen::Vector2d& sides,
                                    const OutlineOptions& options) {
  if (!options.periodic_u && !options.periodic_v && !options.pole_start && !options.pole_end)
    return points;
  Places places;
  for (Eigen::Index k = 0; k < points.cols(); ++k) places.push_back(points.col(k));
  if (options.stretch_u) FillRows(sides, options, places);
  if (options.pole_start) FillPole(0, sides[0], places);
  if (options.pole_end) FillPole(sides[1], sides[0], places);
  if (options.periodic_u) Repeat(0, sides[0], places);
  if (options.periodic_v) Repeat(1, sides[1], places);
  Eigen::Matrix2Xd result(2, static_cast<Eigen::Index>(places.size()));
  for (size_t k = 0; k < places.size(); ++k) result.col(static_cast<Eigen::Index>(k)) = places[k];
  return result;
}

}  // namespace batten::internal
