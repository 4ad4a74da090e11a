// SPDX-License-Identifier: MIT
#include "fitting/regions/border_walk.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace batten::internal {

double FarFrom(const BorderPlaces& places, const Eigen::Vector3d& place) {
  double least = std::numeric_limits<double>::infinity();
  for (const Eigen::Vector3d& one : places) least = std::min(least, (one - place).squaredNorm());
  return std::sqrt(least);
}

namespace {

// The nearest end ahead at which the faces are tangent; none: nullptr.
const WalkEnd* FadeAhead(const std::vector<WalkEnd>& ends,
                         const Eigen::Vector3d& here,
                         const Eigen::Vector3d& way) {
  constexpr double kAhead = 0.9;  // cosine
  const WalkEnd* nearest = nullptr;
  for (const WalkEnd& end : ends) {
    const Eigen::Vector3d off = end.place - here;
    if (!end.fades || !(off.dot(way) > kAhead * off.norm())) continue;
    if (nearest == nullptr || off.norm() < (nearest->place - here).norm()) nearest = &end;
  }
  return nearest;
}

// How far along a step a place is passed, as a share of it, at most so far aside; none where it is
// not.
std::optional<double> Passed(const Eigen::Vector3d& here,
                             const Eigen::Vector3d& step,
                             const Eigen::Vector3d& place,
                             double aside) {
  const double along = (place - here).dot(step) / step.squaredNorm();
  const double off = (place - here - along * step).norm();
  if (!(along > 0 && along <= 1 && off <= aside)) return std::nullopt;
  return along;
}

}  // namespace

BorderWalk FollowBorder(const FaceMeets& meets,
                        const FacePair& faces,
                        const BorderPlaces& places,
                        const std::vector<WalkEnd>& ends,
                        const Eigen::Vector3d& from,
                        const Eigen::Vector3d& way,
                        int start) {
  // Spacings, but for the sine of a turn and the share of a step.
  constexpr double kStep = 0.5, kShort = 1.0 / 64, kLost = 4;
  constexpr double kMostTurn = 0.15, kPassed = 0.2;
  constexpr std::size_t kMost = 100000;
  const double spacing = meets.spacing();
  BorderWalk walk{{from}, -1, false, way, from};
  double step = kStep * spacing;
  while (walk.points.size() < kMost) {
    const Eigen::Vector3d here = walk.points.back();
    const WalkEnd* const fade = FadeAhead(ends, here, walk.way);
    const bool fading = fade != nullptr && meets.SineAt(faces, here) < 2 * kTangent;
    // Across the border a place is known to noise over the sine.
    const double least =
        fading ? std::min(kTangent, meets.same() / (kPassed * (fade->place - here).norm()))
               : kTangent;
    const auto next = PlaceOn(meets.Cutting(faces), here + step * walk.way, step, least);
    Eigen::Vector3d turned = next ? meets.TangentAt(faces, *next) : walk.way;
    if (turned.dot(walk.way) < 0) turned = -turned;
    if (!next || turned.cross(walk.way).norm() > kMostTurn) {
      step /= 2;
      if (step >= kShort * spacing) continue;
      if (fading) walk.end = fade->vertex;
      break;
    }
    const Eigen::Vector3d ahead = *next - here;
    const bool left = walk.points.size() > 2;
    double first = std::numeric_limits<double>::infinity();
    for (const WalkEnd& end : ends) {
      if (end.vertex == start && !left) continue;
      // Vertices of several faces are within noise of each.
      const auto along = Passed(here, ahead, end.place, std::max(meets.same(), kPassed * step));
      if (!along || !(*along < first)) continue;
      first = *along;
      walk.end = end.vertex;
      walk.way = turned;
    }
    if (walk.end >= 0) return walk;
    if (start < 0 && left && Passed(here, ahead, from, kPassed * step)) {
      walk.closed = true;
      return walk;
    }
    walk.points.push_back(*next);
    walk.way = turned;
    step = std::min(kStep * spacing, 1.5 * step);
    const double far = FarFrom(places, *next);
    if (far <= spacing) walk.seen = *next;
    const bool hidden = std::any_of(ends.begin(), ends.end(), [&](const WalkEnd& end) {
      const Eigen::Vector3d off = end.place - *next;
      return off.norm() <= end.reach && off.dot(walk.way) > 0;
    });
    if (far > kLost * spacing && !hidden && !fading) break;
  }
  return walk;
}

}  // namespace batten::internal
