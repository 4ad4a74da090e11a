// SPDX-License-Identifier: MIT
#include "fitting/corners/corner_noise.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "batten/fitting/statistics.h"

namespace batten::internal {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

constexpr Index kFewest = 200, kMostPlaces = 2000;
constexpr Index kLength = 7;            // points that a difference of the highest order takes
constexpr double kStraightShare = 0.1;  // of places where three points may be in line
constexpr double kLeastHeight = 0.04;   // of the noise: less is in line; noise has three times that
constexpr double kAlike = 1.35;         // between the largest and the smallest estimate

// Quartiles of the length of a vector of independent standard normal coordinates.
struct Law {
  double low, high;
};
constexpr Law kOneAcross{0.3186393639643752, 1.1503493803760079};
constexpr Law kTwoAcross{0.7585276164410930, 1.6651092223153954};

constexpr std::array<std::array<double, kLength>, 3> kDifferences = {{
    {0, 1, -4, 6, -4, 1, 0},
    {-1, 5, -10, 10, -5, 1, 0},
    {1, -6, 15, -20, 15, -6, 1},
}};

double Norm(const std::array<double, kLength>& weights) {
  double squares = 0;
  for (const double w : weights) squares += w * w;
  return std::sqrt(squares);
}

// Of points k … k + 6, across the direction from the first to the last.
double Across(const Eigen::Matrix3Xd& points, Index k, const std::array<double, kLength>& weights) {
  const Vector3d along = (points.col(k + kLength - 1) - points.col(k)).normalized();
  Vector3d sum = Vector3d::Zero();
  for (Index i = 0; i < kLength; ++i) sum += weights[static_cast<size_t>(i)] * points.col(k + i);
  return (sum - sum.dot(along) * along).norm();
}

// How far a point is from the line through its neighbours, at every stride-th: the height that a
// tenth of them stays below. Points of a polygon are in line on every side.
double LowHeight(const Eigen::Matrix3Xd& points, Index stride) {
  std::vector<double> heights;
  for (Index k = 1; k + 1 < points.cols(); k += stride) {
    const Vector3d chord = (points.col(k + 1) - points.col(k - 1)).normalized(),
                   off = points.col(k) - points.col(k - 1);
    heights.push_back((off - off.dot(chord) * chord).norm());
  }
  return Quantile(std::move(heights), kStraightShare);
}

}  // namespace

double NoiseShown(const Eigen::Matrix3Xd& points) {
  const Index m = points.cols();
  if (m < kFewest) return 0;
  const Index stride = 1 + m / kMostPlaces;
  std::array<std::vector<double>, 3> lengths;
  for (Index k = 0; k + kLength <= m; k += stride) {
    for (size_t order = 0; order < 3; ++order)
      lengths[order].push_back(Across(points, k, kDifferences[order]) / Norm(kDifferences[order]));
  }
  for (const Law& law : {kOneAcross, kTwoAcross}) {
    std::vector<double> noise;
    for (const std::vector<double>& values : lengths) {
      noise.push_back(Quantile(values, 0.25) / law.low);
      noise.push_back(Quantile(values, 0.75) / law.high);
    }
    const auto [least, most] = std::minmax_element(noise.begin(), noise.end());
    if (*least > 0 && *most <= kAlike * *least)
      return LowHeight(points, stride) >= kLeastHeight * *least ? *least : 0;
  }
  return 0;
}

}  // namespace batten::internal
