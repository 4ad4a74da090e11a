// SPDX-License-Identifier: MIT
#include "fitting/outline/four_sides.h"

#include <cmath>
#include <numbers>
#include <vector>

#include "fitting/core/rounding.h"
#include "fitting/outline/outline_spline.h"

namespace batten::internal {
namespace {

constexpr double kLeastTurn = 50 * kOneDegree, kMostTurn = 130 * kOneDegree,
                 kMostOff = 60 * kOneDegree;

double AngleBetween(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b));
}

// What lies between two knots of full multiplicity (or ends).
NurbsCurve<2> Part(const NurbsCurve<2>& loop, double from, double to) {
  const SplineBasis& basis = loop.basis();
  const int p = basis.degree();
  const int first = basis.Span(from) - p;
  const int last = to < basis.upper() ? basis.Span(to) - p : basis.size() - 1;
  const Eigen::Matrix2Xd points = loop.control_points().middleCols(first, last - first + 1);
  if (p == 1) {
    Eigen::Matrix2Xd cubic(2, kOutlineDegree + 1);
    for (int i = 0; i <= kOutlineDegree; ++i)
      cubic.col(i) = points.col(0) + (points.col(1) - points.col(0)) * i / kOutlineDegree;
    cubic.col(kOutlineDegree) = points.col(1);
    return {SplineBasis::Uniform(kOutlineDegree, kOutlineDegree + 1, from, to), cubic};
  }
  std::vector<double> knots(static_cast<size_t>(p + 1), from);
  for (int k = first + p + 1; k <= last; ++k) knots.push_back(basis.knots()[k]);
  knots.insert(knots.end(), static_cast<size_t>(p + 1), to);
  return {SplineBasis(p, knots), points};
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

std::optional<std::array<OutlineSide, 4>> FourSides(const OutlineCurve& outer) {
  const NurbsCurve<2>& loop = outer.loop;
  const int p = loop.basis().degree();
  if (outer.corners.size() != 4 || outer.corners.front() != loop.basis().lower()) return {};
  if ((p != 1 && p != kOutlineDegree) || loop.rational()) return {};
  std::vector<NurbsCurve<2>> parts;
  for (size_t k = 0; k < 4; ++k)
    parts.push_back(
        Part(loop, outer.corners[k], k < 3 ? outer.corners[k + 1] : loop.basis().upper()));
  size_t first = 0;
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
      first = k;
    }
  }
  return std::array<OutlineSide, 4>{OutlineSide{parts[first]},
                                    OutlineSide{parts[(first + 1) % 4]},
                                    OutlineSide{parts[(first + 2) % 4]},
                                    OutlineSide{parts[(first + 3) % 4]}};
}

}  // namespace batten::internal
