// SPDX-License-Identifier: MIT
#include "fitting/ordering/curve_closure.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>

#include "fitting/core/rounding.h"
#include "fitting/core/shared_constants.h"
#include "geometry/numeric/dense_solvers.h"
#include "geometry/numeric/polygon.h"

namespace batten::internal {
namespace {

constexpr double kGapInSteps = 3;
constexpr double kLongestStep = 1.5;                      // of the mean of those near it
constexpr double kShortestStep = 0.3;                     // a shorter gap is a blunt end
constexpr double kCornerTurn = 2 * std::numbers::pi / 3;  // of both ends together
constexpr double kLargestOfSize = 0.3;                    // gaps that noise may explain
constexpr double kDirectionError = 0.12;                  // radians
constexpr Eigen::Index kStepsNearby = 4;

// Estimates of one end from the points near it.
struct End {
  Eigen::Vector3d place;
  Eigen::Vector3d inward;  // unit, or zero where the points say nothing
  double step;             // mean, along the curve
  double noise;            // standard deviation of the place
};

// The number of points needed for the direction of a quadratic at its end, whose standard deviation
// over k even points on a length L is about 14 σ / (L √k).
Eigen::Index PointsNeeded(const Eigen::Matrix3Xd& points, Eigen::Index most, double noise) {
  Eigen::Index count = std::min<Eigen::Index>(3, most);
  while (count < most) {
    const double length = (points.col(count - 1) - points.col(0)).norm();
    const double error = 14 * noise / std::sqrt(static_cast<double>(count));
    if (length - 2 * noise > 0 && error <= kDirectionError * (length - 2 * noise)) break;
    count += 1 + count / 8;
  }
  return std::min(count, most);
}

// Sums of steps for few points, even steps where noise would lengthen them.
Eigen::VectorXd Places(const Eigen::Matrix3Xd& points, Eigen::Index count) {
  Eigen::VectorXd places = Eigen::VectorXd::LinSpaced(count, 0, 1);
  if (count > 4) return places;
  for (Eigen::Index k = 1; k < count; ++k) {
    places[k] = places[k - 1] + (points.col(k) - points.col(k - 1)).norm();
  }
  if (places[count - 1] > 0) places /= places[count - 1];
  return places;
}

// The quadratic a + b t + c t² (columns) of least summed distances, by reweighting.
Eigen::Matrix3d Quadratic(const Eigen::Matrix3Xd& points, const Eigen::VectorXd& places) {
  const Eigen::Index count = places.size();
  const Eigen::Vector3d origin = points.col(0);
  Eigen::VectorXd weights = Eigen::VectorXd::Ones(count);
  Eigen::Matrix3d coefficients = Eigen::Matrix3d::Zero();
  for (int round = 0; round < (count > 4 ? 8 : 1); ++round) {
    Eigen::Matrix3d gram = Eigen::Matrix3d::Zero(), moments = Eigen::Matrix3d::Zero();
    for (Eigen::Index k = 0; k < count; ++k) {
      const Eigen::Vector3d powers(1, places[k], places[k] * places[k]);
      gram += weights[k] * powers * powers.transpose();
      moments += weights[k] * powers * (points.col(k) - origin).transpose();
    }
    coefficients = SymmetricSolutions3(gram, moments).transpose();
    Eigen::VectorXd distances(count);
    for (Eigen::Index k = 0; k < count; ++k) {
      const Eigen::Vector3d powers(1, places[k], places[k] * places[k]);
      distances[k] = (points.col(k) - origin - coefficients * powers).norm();
    }
    const double floor = 0.1 * distances.mean();
    if (!(floor > 0)) break;
    weights = distances.cwiseMax(floor).cwiseInverse() * floor;
  }
  coefficients.col(0) += origin;
  return coefficients;
}

// The end at the first point.
End EndOf(const Eigen::Matrix3Xd& points, double noise) {
  const Eigen::Index most = std::max<Eigen::Index>(3, points.cols() / 4);
  const Eigen::Index count = PointsNeeded(points, most, noise);
  const Eigen::VectorXd places = Places(points, count);
  const Eigen::Matrix3d coefficients = Quadratic(points, places);
  End result;
  result.place = count > 4 ? Eigen::Vector3d(coefficients.col(0)) : Eigen::Vector3d(points.col(0));
  result.inward = coefficients.col(1).stableNormalized();
  // A quadratic of k points knows its end to 3 σ / √k, a little worse with absolute distances.
  result.noise = noise * std::min(1.0, 3.8 / std::sqrt(static_cast<double>(count)));
  if (count > 4) {
    result.step =
        coefficients.rightCols<2>().rowwise().sum().norm() / static_cast<double>(count - 1);
  } else {
    const Eigen::Index steps = std::min(kStepsNearby, points.cols() - 1);
    result.step = PolygonLength(points.leftCols(steps + 1)) / static_cast<double>(steps);
  }
  return result;
}

double Angle(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  if (a.isZero(0) || b.isZero(0)) return std::numbers::pi;
  return AngleBetween(a, b);
}

// The greatest over the least of the two steps next to each end.
double Unevenness(const Eigen::Matrix3Xd& points) {
  Eigen::Vector4d steps;
  steps << StepLengths(points.leftCols<3>()), StepLengths(points.rightCols<3>());
  return steps.maxCoeff() / steps.minCoeff();
}

bool Closes(const Eigen::Matrix3Xd& points, const End& first, const End& last) {
  const Eigen::Vector3d across = first.place - last.place;
  const double gap = across.norm();
  const double leaving = Angle(-last.inward, across), arriving = Angle(across, first.inward);
  const double step = 0.5 * (first.step + last.step);
  if (gap <= kThreeSigmas * std::hypot(first.noise, last.noise) && gap <= kLargestOfSize) {
    return true;
  }
  if (std::max(leaving, arriving) <= kFacingAngle) {
    const bool near =
        gap <= kGapInSteps * step + kThreeSigmas * std::hypot(first.noise, last.noise);
    if (near && gap <= kGapInLength * PolygonLength(points)) return true;
  }
  const bool corner =
      std::min(leaving, arriving) <= kFacingAngle || leaving + arriving <= kCornerTurn;
  return corner && gap <= kLongestStep * step && gap >= kShortestStep * step &&
         Unevenness(points) < kLongestStep;
}

}  // namespace

EndGap JudgeEnds(const Eigen::Matrix3Xd& points, double noise) {
  if (points.cols() == 0) throw std::invalid_argument("JudgeEnds: points must not be empty");
  if (!(noise >= 0) || !std::isfinite(noise)) {
    throw std::invalid_argument("JudgeEnds: noise is " + std::to_string(noise) +
                                ", must be finite and at least 0");
  }
  EndGap result;
  const Eigen::Index count = points.cols();
  result.gap = (points.col(count - 1) - points.col(0)).stableNorm();
  const double size = (points.rowwise().maxCoeff() - points.rowwise().minCoeff()).stableNorm();
  if (count < 3 || !(size > 0)) return result;
  const double rounding = 4 * std::numeric_limits<double>::epsilon() * points.cwiseAbs().maxCoeff();
  result.repeated = result.gap <= std::max(kRelativelyEqual * size, rounding);
  result.closed = result.repeated;
  if (result.repeated || count == 3) return result;
  const Eigen::Matrix3Xd local = (points.colwise() - points.col(0)) / size;
  result.closed =
      Closes(local, EndOf(local, noise / size), EndOf(local.rowwise().reverse(), noise / size));
  return result;
}

}  // namespace batten::internal
