// SPDX-License-Identifier: MIT
#include "fitting/flattening/border_corners.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "batten/fitting/statistics.h"
#include "fitting/core/rounding.h"

namespace batten::internal {
namespace {

// Lengths of chords in reaches, and as shares of the sheet's width where that is less. Shorter ones
// see notches of the border, longer ones the bends of its sides. [measured: kind_fitting]
constexpr double kChordInReaches[] = {4, 6.4};
constexpr double kChordInWidths[] = {0.45, 0.65};
constexpr double kApart = 1;  // of the shorter chord, between corners
// Turning of a corner, radians. At less a border without corners seems to have some; corners that
// turn by less stay unseen. [measured: true ones above 55°, others below 37°]
constexpr double kLeastTurning = 40 * kOneDegree;
constexpr double kClear = 1.4;  // times the fifth largest

// A closed polygon by its length.
class ClosedPolygon {
 public:
  ClosedPolygon(const Eigen::Matrix3Xd& places, const std::vector<int>& loop) {
    for (const int node : loop) corners_.emplace_back(places.col(node));
    at_.push_back(0);
    for (size_t k = 0; k < corners_.size(); ++k)
      at_.push_back(at_.back() + (corners_[(k + 1) % corners_.size()] - corners_[k]).norm());
  }

  double length() const { return at_.back(); }
  double At(size_t k) const { return at_[k]; }

  Eigen::Vector3d Place(double s) const {
    s -= length() * std::floor(s / length());
    const auto next = std::upper_bound(at_.begin() + 1, at_.end() - 1, s);
    const auto k = static_cast<size_t>(next - at_.begin()) - 1;
    const double step = at_[k + 1] - at_[k];
    const double share = step > 0 ? (s - at_[k]) / step : 0;
    return corners_[k] + share * (corners_[(k + 1) % corners_.size()] - corners_[k]);
  }

  double Between(size_t a, size_t b) const {
    const double way = std::abs(at_[a] - at_[b]);
    return std::min(way, length() - way);
  }

 private:
  std::vector<Eigen::Vector3d> corners_;
  std::vector<double> at_;
};

}  // namespace

BorderCorners FourCornersOf(const PoissonDiskSamples& nodes,
                            const std::vector<int>& loop,
                            double width) {
  const ClosedPolygon border(nodes.places, loop);
  std::vector<double> reaches;
  for (const int node : loop) reaches.push_back(nodes.reach[node]);
  const double reach = Median(reaches);
  std::array<double, 2> chords{};
  for (size_t c = 0; c < chords.size(); ++c)
    chords[c] = std::min(kChordInReaches[c] * reach, kChordInWidths[c] * width);
  std::vector<double> turnings(loop.size());
  for (size_t k = 0; k < loop.size(); ++k) {
    const Eigen::Vector3d normal = nodes.normals.col(loop[k]), place = border.Place(border.At(k));
    turnings[k] = std::numbers::pi;
    for (const double chord : chords) {
      const auto flat = [&](const Eigen::Vector3d& way) {
        return (way - normal * normal.dot(way)).eval();
      };
      const Eigen::Vector3d to = flat(place - border.Place(border.At(k) - chord)),
                            from = flat(border.Place(border.At(k) + chord) - place);
      turnings[k] = std::min(turnings[k], std::atan2(normal.dot(to.cross(from)), to.dot(from)));
    }
  }
  std::vector<size_t> found;
  while (found.size() < 5) {
    size_t best = loop.size();
    for (size_t k = 0; k < loop.size(); ++k) {
      const bool near = std::any_of(found.begin(), found.end(), [&](size_t other) {
        return border.Between(k, other) < kApart * chords[0];
      });
      if (!near && (best == loop.size() || turnings[k] > turnings[best])) best = k;
    }
    if (best == loop.size()) break;
    found.push_back(best);
  }
  BorderCorners corners;
  const auto turning = [&](size_t k) { return found.size() > k ? turnings[found[k]] : 0.0; };
  if (turning(3) < kLeastTurning || turning(3) < kClear * turning(4)) {
    const auto degrees = [](double angle) {
      return std::to_string(std::lround(angle * 180 / std::numbers::pi));
    };
    corners.failure_reason = "the border of the sheet has not four corners: it turns by " +
                             degrees(turning(3)) + " degrees at the fourth sharpest, by " +
                             degrees(turning(4)) + " at the fifth";
    return corners;
  }
  std::copy_n(found.begin(), 4, corners.at.begin());
  std::sort(corners.at.begin(), corners.at.end());
  return corners;
}

}  // namespace batten::internal
