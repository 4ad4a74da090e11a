// SPDX-License-Identifier: MIT
// Corner test of one window: a parabola with one kink against smooth curves. Used by the search for
// corners only.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace batten::internal {

inline constexpr size_t kMostMeans = 48;

// A window of consecutive means p of n points each, at mean parameters u.
struct KinkWindow {
  std::vector<double> u, n;
  std::vector<Eigen::Vector3d> p;
};

struct Kink {
  double parameter = 0, angle = 0;
  double reach = 0;    // half the window it was found in
  double squares = 0;  // weighted sum of squared residuals
  Eigen::Vector3d place = Eigen::Vector3d::Zero();
};

struct PointClass {
  bool corner = false;
  bool turns = false;  // in a way that a cubic does not explain
  Kink kink;           // the one that fits best
};

// Fits the best parabola with one kink near `at` and decides whether it is a corner: it turns by
// the least angle, beats the cubic, the quartic, the sextic and turns that take a sixth of the
// window to half of it, the latter clearly unless its sides are straight, and turns that are a
// little rounded do not beat it, all measured in the variance of the noise. `noise` is the standard
// deviation of a coordinate of a single point, `chances` the logarithm of how many such windows
// there are. O(means).
PointClass KinkOf(
    const KinkWindow& window, double at, double noise, double least_angle, double chances);

// Whether the cubic or the quartic fits clearly better than the best parabola with a kink at `at`.
bool IsSmoother(const KinkWindow& window, double at, double noise);

}  // namespace batten::internal
