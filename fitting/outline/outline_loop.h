// SPDX-License-Identifier: MIT
// The ragged border of a cloud resampled for smoothing. Lengths are in units of the cloud's
// spacing.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

namespace batten::internal {

struct OutlineSample {
  Eigen::Vector2d place;     // smoothed over some spacings, offset outwards
  Eigen::Vector2d measured;  // on the ragged border, offset by the same amount
  bool corner = false;       // a corner: place is where its sides meet
  bool along_cut = false;    // the border runs straight along a cut to the next sample
  bool pinned = false;       // the border runs straight to the next sample, and is not to be moved
  Eigen::Vector2d border;    // where the ragged border itself runs
  std::vector<Eigen::Vector2d> vertices;  // of the ragged border, between here and the next sample
};

// A closed loop with the covered region on its left.
using OutlineLoop = std::vector<OutlineSample>;

// By how much an outline lies outside the ragged border at a place of it.
using Outwards = std::function<double(const Eigen::Vector2d&)>;

inline constexpr double kBorderStep = 0.5;  // between samples, about

// Samples a closed polygon about every half spacing, with its corners, offset outwards. O(length).
OutlineLoop SampledOutline(const Eigen::Matrix2Xd& polygon, const Outwards& outwards);

// A disc in which an outline follows the ragged border.
struct OutlinePin {
  Eigen::Vector2d place;
  double radius;

  bool Holds(const OutlineSample& sample) const { return (sample.border - place).norm() < radius; }
};

// Puts the stretches in the disc back on the ragged border, vertex by vertex: it never crosses
// itself, what is smoothed may; where it runs back along its own line, as far as that is left out.
// Stretches along cuts stay.
void PinToBorder(OutlineLoop& loop, const OutlinePin& pin);

Eigen::Matrix2Xd PolygonOf(const OutlineLoop& loop);  // of the places

// Clips a region to the half plane n·x ≥ c, n = ±e_axis, with new corners where its borders cross
// the edge. Borders that cross the edge are joined along it.
std::vector<OutlineLoop> CutOutlines(const std::vector<OutlineLoop>& loops,
                                     int axis,
                                     double sign,
                                     double at);

}  // namespace batten::internal
