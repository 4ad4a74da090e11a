// SPDX-License-Identifier: MIT
#include "batten/fitting/curve_corners.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

#include "batten/fitting/corner_turns.h"
#include "batten/fitting/corner_windows.h"
#include "batten/fitting/statistics.h"

namespace batten {
namespace {

using Eigen::Index;

constexpr double kExact = 0.02;  // of the spacing: noise that leaves the direction of single steps

[[noreturn]] void Refuse(const std::string& reason) {
  throw std::invalid_argument("FindCorners: " + reason);
}

void CheckParameters(const Eigen::Matrix3Xd& points,
                     const Eigen::VectorXd& parameters,
                     const CornerOptions& options) {
  if (parameters.size() != points.cols()) {
    Refuse("parameters must be one a point, got " + std::to_string(parameters.size()) + " for " +
           std::to_string(points.cols()) + " points");
  }
  for (Index k = 1; k < parameters.size(); ++k) {
    if (!(parameters[k] > parameters[k - 1]))
      Refuse("parameters must increase, parameter " + std::to_string(k) + " does not");
  }
  if (options.closed && parameters.size() > 0 &&
      !(parameters[parameters.size() - 1] - parameters[0] <= options.period * (1 + 1e-12))) {
    Refuse("parameters of a closed curve must not exceed its period, " +
           std::to_string(options.period));
  }
}

double MedianStep(const Eigen::Matrix3Xd& points) {
  std::vector<double> steps;
  for (Index k = 1; k < points.cols(); ++k)
    steps.push_back((points.col(k) - points.col(k - 1)).norm());
  return Median(std::move(steps));
}

// Of points at one place in a row the first; on a closed curve the first follows the last.
std::vector<Index> Different(const Eigen::Matrix3Xd& points, bool closed) {
  std::vector<Index> kept;
  for (Index k = 0; k < points.cols(); ++k) {
    if (kept.empty() || points.col(k) != points.col(kept.back())) kept.push_back(k);
  }
  while (closed && kept.size() > 1 && points.col(kept.back()) == points.col(kept.front()))
    kept.pop_back();
  return kept;
}

}  // namespace

void Check(const CornerOptions& options) {
  const auto require = [](bool kept, const char* field, double value, const char* rule) {
    if (!kept) {
      throw std::invalid_argument(std::string("CornerOptions: ") + field + " is " +
                                  std::to_string(value) + ", must be " + rule);
    }
  };
  require(options.noise >= 0 && std::isfinite(options.noise),
          "noise",
          options.noise,
          "0 or more and finite");
  require(!options.closed || (options.period > 0 && std::isfinite(options.period)),
          "period",
          options.period,
          "above 0 and finite for a closed curve");
  require(options.least_angle > 0 && options.least_angle < std::numbers::pi,
          "least_angle",
          options.least_angle,
          "above 0 and below pi");
}

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
  std::vector<CurveCorner> corners = options.noise <= kExact * MedianStep(local)
                                         ? CornersOfExact(local, u, options)
                                         : CornersOfNoisy(local, u, options);
  for (CurveCorner& corner : corners) corner.place += origin;
  std::sort(corners.begin(), corners.end(), [](const CurveCorner& a, const CurveCorner& b) {
    return a.parameter < b.parameter;
  });
  return corners;
}

}  // namespace batten
