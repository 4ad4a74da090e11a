// SPDX-License-Identifier: MIT
#include "fitting/corners/curve_corners.h"

#include <algorithm>
#include <string>

#include "batten/fitting/statistics.h"
#include "fitting/core/rounding.h"
#include "fitting/corners/corner_noise.h"
#include "fitting/corners/corner_screen.h"
#include "fitting/corners/corner_turns.h"
#include "fitting/corners/corner_windows.h"
#include "geometry/numeric/reject.h"

namespace batten::internal {
namespace {

using Eigen::Index;

constexpr double kExact = 0.02;  // in spacings: below it single steps keep their direction

constexpr double kNoisy = 0.05;  // in spacings: above it points are not exact
constexpr double kClearlyMore = 1.15;
constexpr Index kMostSteps = 5000;  // about, of which a median is taken

void CheckParameters(const Eigen::Matrix3Xd& points,
                     const Eigen::VectorXd& parameters,
                     const CornerOptions& options) {
  if (parameters.size() != points.cols()) {
    Reject("FindCorners",
           "parameters must be one a point, got " + std::to_string(parameters.size()) + " for " +
               std::to_string(points.cols()) + " points");
  }
  for (Index k = 1; k < parameters.size(); ++k) {
    if (!(parameters[k] > parameters[k - 1]))
      Reject("FindCorners",
             "parameters must increase, parameter " + std::to_string(k) + " does not");
  }
  if (options.closed && parameters.size() > 0 &&
      !(parameters[parameters.size() - 1] - parameters[0] <=
        options.period * (1 + kRelativeRounding))) {
    Reject("FindCorners",
           "parameters of a closed curve must not exceed its period, " +
               std::to_string(options.period));
  }
}

template <typename Points>
double MedianStep(const Eigen::MatrixBase<Points>& points) {
  std::vector<double> steps;
  const Index stride = 1 + points.cols() / kMostSteps;
  for (Index k = 1; k < points.cols(); k += stride)
    steps.push_back((points.col(k) - points.col(k - 1)).norm());
  return Median(std::move(steps));
}

// Keeps the first of consecutive coincident points; on a closed curve the first follows the last.
std::vector<Index> Different(const Eigen::Matrix3Xd& points, bool closed) {
  std::vector<Index> kept;
  for (Index k = 0; k < points.cols(); ++k) {
    if (kept.empty() || points.col(k) != points.col(kept.back())) kept.push_back(k);
  }
  while (closed && kept.size() > 1 && points.col(kept.back()) == points.col(kept.front()))
    kept.pop_back();
  return kept;
}

// Each range as an open curve of its own.
std::vector<CurveCorner> CornersOfRanges(const Eigen::Matrix3Xd& points,
                                         const Eigen::VectorXd& parameters,
                                         const CornerOptions& options) {
  const std::vector<CornerRange> ranges =
      RangesWithCorners(points, MedianStep(parameters.transpose()), options);
  const Index m = points.cols();
  std::vector<CurveCorner> corners;
  for (const CornerRange& range : ranges) {
    if (range.size == m) return CornersOfNoisy(points, parameters, options);
    Eigen::Matrix3Xd part(3, range.size);
    Eigen::VectorXd u(range.size);
    for (Index i = 0; i < range.size; ++i) {
      const Index k = range.begin + i, inside = (k % m + m) % m;
      part.col(i) = points.col(inside);
      u[i] = parameters[inside] + (k < 0 ? -1 : k >= m ? 1 : 0) * options.period;
    }
    CornerOptions open = options;
    open.closed = false;
    for (CurveCorner corner : CornersOfNoisy(part, u, open)) {
      if (corner.parameter < parameters[0]) corner.parameter += options.period;
      if (options.closed && corner.parameter >= parameters[0] + options.period)
        corner.parameter -= options.period;
      corners.push_back(corner);
    }
  }
  return corners;
}

}  // namespace

std::vector<CurveCorner> FindCorners(const Eigen::Matrix3Xd& points,
                                     const Eigen::VectorXd& parameters,
                                     const CornerOptions& options) {
  Check(options);
  CheckParameters(points, parameters, options);
  const std::vector<Index> kept = Different(points, options.closed);
  if (kept.size() < 5) return {};
  const Eigen::VectorXd u = parameters(kept);
  const Eigen::Vector3d origin = points.col(kept[0]);
  const Eigen::Matrix3Xd local = points(Eigen::all, kept).colwise() - origin;
  const double step = MedianStep(local), own = NoiseShown(local);
  CornerOptions used = options;
  if (own > kClearlyMore * options.noise && own > kNoisy * step) used.noise = own;
  std::vector<CurveCorner> corners = used.noise <= kExact * step ? CornersOfExact(local, u, used)
                                                                 : CornersOfRanges(local, u, used);
  for (CurveCorner& corner : corners) corner.place += origin;
  std::sort(corners.begin(), corners.end(), [](const CurveCorner& a, const CurveCorner& b) {
    return a.parameter < b.parameter;
  });
  return corners;
}

}  // namespace batten::internal
