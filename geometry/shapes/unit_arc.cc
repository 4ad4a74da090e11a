// SPDX-License-Identifier: MIT
#include "geometry/shapes/unit_arc.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace batten::internal {
namespace {

constexpr double kQuarter = std::numbers::pi / 2;

int PiecesOf(const AngleRange& angles) {
  constexpr double kRounding = 1e-12;
  return std::max(1, static_cast<int>(std::ceil(angles.sweep / kQuarter - kRounding)));
}

SplineBasis ArcBasis(int pieces) {
  std::vector<double> knots(3, 0.0);
  for (int k = 1; k < pieces; ++k) knots.insert(knots.end(), 2, static_cast<double>(k) / pieces);
  knots.insert(knots.end(), 3, 1.0);
  return SplineBasis(2, std::move(knots));
}

// cos(angle) − 1
double LessOne(double angle) {
  const double s = std::sin(angle / 2);
  return -2 * s * s;
}

}  // namespace

Eigen::Vector2d UnitVectorAt(double angle) {
  const double quarters = std::round(angle / kQuarter);
  const double rounding =
      2 * std::numeric_limits<double>::epsilon() * std::max(1.0, std::abs(angle));
  if (std::abs(angle - quarters * kQuarter) > rounding) return {std::cos(angle), std::sin(angle)};
  const int turned = static_cast<int>(quarters - 4 * std::floor(quarters / 4));
  const Eigen::Vector2d directions[] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}};
  return directions[turned];
}

UnitArc::UnitArc(const AngleRange& angles) : UnitArc(angles, PiecesOf(angles)) {}

UnitArc::UnitArc(const AngleRange& angles, int pieces) : basis(ArcBasis(pieces)) {
  const double step = (angles.full() ? 4 * kQuarter : angles.sweep) / pieces;
  const bool quarters = UnitVectorAt(step).x() == 0;
  points.resize(2, 2 * pieces + 1);
  less_one.resize(points.cols());
  weights = Eigen::VectorXd::Ones(points.cols());
  for (int k = 0; k <= pieces; ++k) {
    const double angle = angles.start + (angles.full() && k == pieces ? 0 : k * step);
    points.col(2 * k) = UnitVectorAt(angle);
    if (k > 0 && quarters) {
      points.col(2 * k) = Eigen::Vector2d(-points(1, 2 * k - 2), points(0, 2 * k - 2));
    }
    less_one[2 * k] = LessOne(angle);
  }
  // From the ends as they were rounded, not from the angle: with h half a piece, their sum is
  // 2 cos h long.
  for (int k = 1; k < points.cols(); k += 2) {
    const Eigen::Vector2d sum = points.col(k - 1) + points.col(k + 1);
    const double one_and_cosine = sum.squaredNorm() / 2;
    points.col(k) = sum / one_and_cosine;
    less_one[k] = (less_one[k - 1] + less_one[k + 1] - LessOne(step)) / one_and_cosine;
    weights[k] = std::sqrt(one_and_cosine / 2);
  }
}

}  // namespace batten::internal
