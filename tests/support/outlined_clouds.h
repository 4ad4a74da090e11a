// SPDX-License-Identifier: MIT
// Plane shapes with holes and corners, clouds inside them, and how far loops are from their edges.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <numbers>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "batten/fitting/outline.h"

namespace batten::internal {

using Places = std::vector<Eigen::Vector2d>;

inline double AreaOf(const Places& polygon) {
  double twice = 0;
  for (size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++)
    twice += polygon[j].x() * polygon[i].y() - polygon[j].y() * polygon[i].x();
  return twice / 2;
}

// Loops are closed dense polygons, the outer one first; corners are where they turn sharply.
struct OutlinedShape {
  std::string name;
  std::vector<Places> loops;
  Places corners;

  bool Contains(const Eigen::Vector2d& p) const {
    bool inside = false;
    for (const Places& loop : loops)
      for (size_t i = 0, j = loop.size() - 1; i < loop.size(); j = i++)
        if ((loop[i].y() > p.y()) != (loop[j].y() > p.y()) &&
            p.x() < loop[i].x() + (p.y() - loop[i].y()) / (loop[j].y() - loop[i].y()) *
                                      (loop[j].x() - loop[i].x()))
          inside = !inside;
    return inside;
  }
  double Area() const {
    double sum = 0;
    for (size_t k = 0; k < loops.size(); ++k) sum += (k == 0 ? 1 : -1) * std::abs(AreaOf(loops[k]));
    return sum;
  }
  void Map(const std::function<Eigen::Vector2d(const Eigen::Vector2d&)>& map) {
    for (Places& loop : loops)
      for (Eigen::Vector2d& p : loop) p = map(p);
    for (Eigen::Vector2d& p : corners) p = map(p);
  }
};

inline Places EllipseLoop(double x, double y, double a, double b, int count = 400) {
  Places loop;
  for (int i = 0; i < count; ++i) {
    const double t = 2 * std::numbers::pi * i / count;
    loop.emplace_back(x + a * std::cos(t), y + b * std::sin(t));
  }
  return loop;
}

inline Places BoxLoop(double x0, double y0, double x1, double y1) {
  return {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}};
}

inline OutlinedShape DiscShape() { return {"disc", {EllipseLoop(0.5, 0.5, 0.5, 0.5)}, {}}; }

inline OutlinedShape RingShape() {
  return {"ring", {EllipseLoop(0.5, 0.5, 0.5, 0.5), EllipseLoop(0.5, 0.5, 0.25, 0.25)}, {}};
}

inline OutlinedShape LShape() {
  const Places loop{{0, 0}, {1, 0}, {1, 0.5}, {0.4, 0.5}, {0.4, 1}, {0, 1}};
  return {"L", {loop}, loop};
}

inline OutlinedShape RectangleShape() {
  return {"rectangle", {BoxLoop(0, 0, 1, 0.7)}, BoxLoop(0, 0, 1, 0.7)};
}

inline OutlinedShape StarShape() {
  Places loop;
  for (int i = 0; i < 10; ++i) {
    const double t = 0.1 + std::numbers::pi * i / 5, r = i % 2 == 0 ? 0.5 : 0.25;
    loop.emplace_back(0.5 + r * std::cos(t), 0.5 + r * std::sin(t));
  }
  return {"star", {loop}, loop};
}

// What a circle leaves of another one, with tips of some 60°.
inline OutlinedShape CrescentShape() {
  constexpr double kRadius = 0.5, kOther = 0.45, kAway = 0.35;
  const double x = (kAway * kAway + kRadius * kRadius - kOther * kOther) / (2 * kAway);
  const double first = std::acos(x / kRadius), second = std::acos((x - kAway) / kOther);
  Places loop;
  constexpr int kCount = 300;
  const auto arc = [&](double centre, double radius, double from, double to) {
    for (int i = 0; i < kCount; ++i) {
      const double t = from + (to - from) * i / kCount;
      loop.emplace_back(centre + radius * std::cos(t), radius * std::sin(t));
    }
  };
  arc(0, kRadius, first, 2 * std::numbers::pi - first);
  arc(kAway, kOther, 2 * std::numbers::pi - second, second);
  return {"crescent", {loop}, {{x, kRadius * std::sin(first)}, {x, -kRadius * std::sin(first)}}};
}

// A box with a notch at its right and three holes: two round, one with corners.
inline OutlinedShape PlateShape() {
  const Places outer{{0, 0}, {1, 0}, {1, 0.4}, {0.85, 0.4}, {0.85, 0.6}, {1, 0.6}, {1, 1}, {0, 1}};
  const Places box = BoxLoop(0.35, 0.62, 0.65, 0.8);
  OutlinedShape shape{
      "plate",
      {outer, EllipseLoop(0.3, 0.3, 0.13, 0.13), EllipseLoop(0.7, 0.25, 0.11, 0.11), box},
      outer};
  shape.corners.insert(shape.corners.end(), box.begin(), box.end());
  return shape;
}

// Straight left and right, waves above and below.
inline OutlinedShape WavyShape() {
  constexpr int kCount = 300;
  const auto wave = [](double x) { return 0.04 * std::sin(2 * std::numbers::pi * x * 1.3); };
  Places loop;
  for (int i = 0; i <= kCount; ++i) {
    const double x = 1.0 * i / kCount;
    loop.emplace_back(x, 0.1 + wave(x));
  }
  for (int i = kCount; i >= 0; --i) {
    const double x = 1.0 * i / kCount;
    loop.emplace_back(x, 0.7 + wave(x));
  }
  return {"wavy", {loop}, {{0, 0.1}, {0, 0.7}, {1, 0.1 + wave(1)}, {1, 0.7 + wave(1)}}};
}

enum class Scatter { kRandom, kJittered, kGrid, kScanLines, kUneven };

// About `count` points with a mean spacing of one, in the shape scaled to that; the shape is scaled
// with them and put `pad` inside of the rectangle's edges.
struct OutlinedCloud {
  OutlinedShape shape;
  Eigen::Matrix2Xd points;
  double length_u, length_v;
};

inline OutlinedCloud CloudIn(
    OutlinedShape shape, int count, Scatter scatter, unsigned seed, double pad = 0.5) {
  const double scale = std::sqrt(count / shape.Area());
  Eigen::Vector2d low = shape.loops[0][0], high = low;
  for (const auto& p : shape.loops[0]) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  shape.Map(
      [&](const Eigen::Vector2d& p) { return Eigen::Vector2d(((p - low) * scale).array() + pad); });
  const Eigen::Vector2d sides = (high - low) * scale;
  std::mt19937_64 engine(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  Places kept;
  const auto offer = [&](double u, double v) {
    const Eigen::Vector2d p(u + pad, v + pad);
    if (shape.Contains(p)) kept.push_back(p);
  };
  if (scatter == Scatter::kRandom || scatter == Scatter::kUneven) {
    while (static_cast<int>(kept.size()) < count) {
      const double u = uniform(engine), v = uniform(engine), chance = uniform(engine);
      // density from 1.6 to 0.4 of the mean
      if (scatter == Scatter::kUneven && chance > 1 - 0.75 * u) continue;
      offer(u * sides[0], v * sides[1]);
    }
  } else {
    const double ratio = scatter == Scatter::kScanLines ? std::sqrt(3.0) : 1.0;
    const double du = 1 / ratio, dv = ratio, jitter = scatter == Scatter::kGrid ? 0 : 0.7;
    const double across = scatter == Scatter::kScanLines ? 0.05 : jitter;
    for (double v = dv / 2; v < sides[1]; v += dv)
      for (double u = du / 2; u < sides[0]; u += du)
        offer(u + du * jitter * (uniform(engine) - 0.5), v + dv * across * (uniform(engine) - 0.5));
  }
  OutlinedCloud cloud{
      std::move(shape), Eigen::Matrix2Xd(2, kept.size()), sides[0] + 2 * pad, sides[1] + 2 * pad};
  for (size_t k = 0; k < kept.size(); ++k) cloud.points.col(static_cast<Eigen::Index>(k)) = kept[k];
  return cloud;
}

// Closed polygons along the loops, some tenth of a spacing of one apart.
inline Places PolygonAlong(const NurbsCurve<2>& loop, double step = 0.1) {
  Places polygon;
  for (const int span : loop.basis().Spans()) {
    const double a = loop.basis().knots()[span], b = loop.basis().knots()[span + 1];
    const int count = std::max(4, static_cast<int>(std::ceil((b - a) / step)));
    for (int k = 0; k < count; ++k) polygon.push_back(loop.At(a + (b - a) * k / count));
  }
  return polygon;
}

inline double DistanceTo(const Places& polygon, const Eigen::Vector2d& p) {
  double least = std::numeric_limits<double>::infinity();
  for (size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
    const Eigen::Vector2d way = polygon[i] - polygon[j];
    const double square = way.squaredNorm();
    const double t = square > 0 ? std::clamp(way.dot(p - polygon[j]) / square, 0.0, 1.0) : 0.0;
    least = std::min(least, (polygon[j] + t * way - p).squaredNorm());
  }
  return std::sqrt(least);
}

// The greatest distance either way, near corners (within `near` of one) and elsewhere.
struct OutlineMisfit {
  double smooth = 0, corner = 0;
};

inline OutlineMisfit MisfitOf(const OutlinedShape& shape,
                              const std::vector<Places>& loops,
                              double near = 6) {
  OutlineMisfit misfit;
  const auto measure = [&](const Places& from, const std::vector<Places>& to) {
    double covered = 0;
    for (size_t i = 0, j = from.size() - 1; i < from.size(); j = i++) {
      const double length = (from[i] - from[j]).norm();
      const int count = std::max(1, static_cast<int>(length / 0.5));
      for (int k = 0; k < count; ++k) {
        const Eigen::Vector2d p = from[j] + (from[i] - from[j]) * k / count;
        covered += length / count;
        if (covered < 0.4) continue;
        covered = 0;
        double least = std::numeric_limits<double>::infinity();
        for (const Places& loop : to) least = std::min(least, DistanceTo(loop, p));
        const bool corner = std::any_of(shape.corners.begin(),
                                        shape.corners.end(),
                                        [&](const auto& c) { return (c - p).norm() < near; });
        double& worst = corner ? misfit.corner : misfit.smooth;
        worst = std::max(worst, least);
      }
    }
  };
  for (const Places& loop : loops) measure(loop, shape.loops);
  for (const Places& loop : shape.loops) measure(loop, loops);
  return misfit;
}

inline double PerimeterOf(const std::vector<Places>& loops) {
  double sum = 0;
  for (const Places& loop : loops)
    for (size_t i = 0, j = loop.size() - 1; i < loop.size(); j = i++)
      sum += (loop[i] - loop[j]).norm();
  return sum;
}

inline double TotalArea(const std::vector<Places>& loops) {
  double sum = 0;
  for (const Places& loop : loops) sum += AreaOf(loop);
  return sum;
}

// Points beyond an outline, by the borders crossed on the way to the left.
inline int PointsBeyond(const std::vector<Places>& loops, const Eigen::Matrix2Xd& points) {
  std::map<long, std::vector<std::pair<Eigen::Vector2d, Eigen::Vector2d>>> rows;
  for (const Places& loop : loops)
    for (size_t i = 0, j = loop.size() - 1; i < loop.size(); j = i++)
      for (long row = std::lround(std::floor(std::min(loop[i].y(), loop[j].y())));
           row <= std::lround(std::floor(std::max(loop[i].y(), loop[j].y())));
           ++row)
        rows[row].emplace_back(loop[i], loop[j]);
  int count = 0;
  for (Eigen::Index k = 0; k < points.cols(); ++k) {
    const Eigen::Vector2d p = points.col(k);
    bool inside = false;
    for (const auto& [a, b] : rows[std::lround(std::floor(p.y()))])
      if ((a.y() > p.y()) != (b.y() > p.y()) &&
          p.x() < a.x() + (p.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x()))
        inside = !inside;
    if (!inside) ++count;
  }
  return count;
}

// Whether two sides of the polygons cross that are not neighbours.
inline bool Crossing(const std::vector<Places>& loops) {
  struct Side {
    Eigen::Vector2d a, b;
    size_t loop, index, count;
  };
  std::vector<Side> sides;
  std::map<std::pair<long, long>, std::vector<size_t>> cells;
  for (size_t l = 0; l < loops.size(); ++l)
    for (size_t i = 0; i < loops[l].size(); ++i) {
      const Side side{loops[l][i], loops[l][(i + 1) % loops[l].size()], l, i, loops[l].size()};
      const Eigen::Vector2d low = side.a.cwiseMin(side.b), high = side.a.cwiseMax(side.b);
      for (long x = std::lround(std::floor(low.x())); x <= std::lround(std::floor(high.x())); ++x)
        for (long y = std::lround(std::floor(low.y())); y <= std::lround(std::floor(high.y())); ++y)
          cells[{x, y}].push_back(sides.size());
      sides.push_back(side);
    }
  const auto turn =
      [](const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
        return (b - a).x() * (c - a).y() - (b - a).y() * (c - a).x();
      };
  for (const auto& [cell, list] : cells)
    for (size_t i = 0; i < list.size(); ++i)
      for (size_t j = 0; j < i; ++j) {
        const Side &s = sides[list[i]], &t = sides[list[j]];
        const size_t away = s.index > t.index ? s.index - t.index : t.index - s.index;
        if (s.loop == t.loop && (away <= 1 || away + 1 >= s.count)) continue;
        if (turn(s.a, s.b, t.a) * turn(s.a, s.b, t.b) < 0 &&
            turn(t.a, t.b, s.a) * turn(t.a, t.b, s.b) < 0)
          return true;
      }
  return false;
}

}  // namespace batten::internal
