// SPDX-License-Identifier: MIT
#include "fitting/outline/four_sides.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "batten/geometry/degree_elevation.h"
#include "batten/geometry/split.h"
#include "fitting/core/rounding.h"
#include "fitting/outline/outline_spline.h"

namespace batten::internal {
namespace {

constexpr double kLeastTurn = 50 * kOneDegree, kMostTurn = 130 * kOneDegree,
                 kMostOff = 60 * kOneDegree;

double AngleBetween(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b));
}

// Whether the side's tangent nowhere deviates from its chord by more than kMostOff.
bool NeverTurnsBack(const NurbsCurve<2>& side) {
  const auto& points = side.control_points();
  const Eigen::Vector2d chord = points.col(points.cols() - 1) - points.col(0);
  const SplineBasis& basis = side.basis();
  constexpr int kSamples = 16;
  for (const int span : basis.Spans()) {
    const double begin = basis.knots()[span], length = basis.knots()[span + 1] - begin;
    for (int k = 0; k <= kSamples; ++k) {
      const Eigen::Vector2d way = side.JetAt(begin + length * k / kSamples).first;
      if (std::abs(AngleBetween(chord, way)) > kMostOff) return false;
    }
  }
  return true;
}

}  // namespace

std::optional<std::vector<NurbsCurve<2>>> FourSides(const OutlineCurve& outer) {
  const NurbsCurve<2>& loop = outer.loop;
  if (outer.corners.size() != 4 || outer.corners.front() != loop.basis().lower() ||
      loop.basis().degree() > kOutlineDegree || loop.rational())
    return {};
  std::vector<NurbsCurve<2>> parts;
  for (size_t k = 0; k < 4; ++k) {
    const double end = k < 3 ? outer.corners[k + 1] : loop.basis().upper();
    parts.push_back(
        Elevated(Segment(loop, outer.corners[k], end), kOutlineDegree - loop.basis().degree()));
  }
  std::ptrdiff_t first = 0;
  double most = -2;
  for (size_t k = 0; k < 4; ++k) {
    const NurbsCurve<2>& next = parts[(k + 1) % 4];
    const Eigen::Vector2d before = parts[k].JetAt(parts[k].basis().upper()).first;
    const double turn = AngleBetween(before, next.JetAt(next.basis().lower()).first);
    if (turn < kLeastTurn || turn > kMostTurn || !NeverTurnsBack(parts[k])) return {};
    const auto& points = parts[k].control_points();
    const double along = (points.col(points.cols() - 1) - points.col(0)).normalized().x();
    if (along > most) {
      most = along;
      first = static_cast<std::ptrdiff_t>(k);
    }
  }
  std::rotate(parts.begin(), parts.begin() + first, parts.end());
  return parts;
}

}  // namespace batten::internal
