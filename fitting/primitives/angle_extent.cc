// SPDX-License-Identifier: MIT
#include "fitting/primitives/angle_extent.h"
#include "geometry/numeric/constants.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace batten::internal {
namespace {

// The first and last of the angles in a sector; sectors without any have first > last.
struct Sector {
  double first = std::numeric_limits<double>::infinity();
  double last = -std::numeric_limits<double>::infinity();
};

}  // namespace

bool AllRound(double widest_gap, Eigen::Index count) {
  constexpr double kMostGap = kTurn / 6, kEven = 1.5;
  const double others = count > 1 ? (kTurn - widest_gap) / static_cast<double>(count - 1) : 0;
  return widest_gap <= kMostGap || widest_gap <= kEven * others;
}

// Gaps within a sector are narrower than it and decide nothing where any is above 60°; with few
// points there are so many sectors that none holds two places.
AngleRange AnglesCovered(const Eigen::VectorXd& angles) {
  constexpr int kSectors = 4096;
  std::vector<Sector> sectors(kSectors);
  for (const double given : angles) {
    const double angle = given - kTurn * std::floor(given / kTurn);
    const int at = std::min(kSectors - 1, static_cast<int>(angle / kTurn * kSectors));
    sectors[static_cast<size_t>(at)].first =
        std::min(sectors[static_cast<size_t>(at)].first, angle);
    sectors[static_cast<size_t>(at)].last = std::max(sectors[static_cast<size_t>(at)].last, angle);
  }
  std::erase_if(sectors, [](const Sector& s) { return s.first > s.last; });
  double widest = sectors.front().first + kTurn - sectors.back().last;
  double start = sectors.front().first;
  for (size_t k = 1; k < sectors.size(); ++k) {
    const double gap = sectors[k].first - sectors[k - 1].last;
    if (gap > widest) {
      widest = gap;
      start = sectors[k].first;
    }
  }
  if (AllRound(widest, angles.size())) return {0, kTurn};
  return {start, kTurn - widest};
}

std::vector<Eigen::Vector2d> OutermostOf(const Eigen::Matrix2Xd& points) {
  constexpr int kDirections = 32;  // in which outermost points are found
  std::vector<Eigen::Vector2d> corners;
  for (int i = 0; i < kDirections; ++i) {
    const double angle = kTurn * i / kDirections;
    Eigen::Index farthest;
    (Eigen::RowVector2d(std::cos(angle), std::sin(angle)) * points).maxCoeff(&farthest);
    const Eigen::Vector2d corner = points.col(farthest);
    if (corners.empty() || corner != corners.back()) corners.push_back(corner);
  }
  const auto inside = [&](const Eigen::Vector2d& p) {
    for (size_t i = 0; i < corners.size(); ++i) {
      const Eigen::Vector2d side = corners[(i + 1) % corners.size()] - corners[i];
      const Eigen::Vector2d from = p - corners[i];
      if (!(side[0] * from[1] - side[1] * from[0] > 0)) return false;
    }
    return true;
  };
  std::vector<Eigen::Vector2d> outermost;
  for (const auto& p : points.colwise()) {
    if (corners.size() < 3 || !inside(p)) outermost.emplace_back(p);
  }
  return outermost;
}

}  // namespace batten::internal
