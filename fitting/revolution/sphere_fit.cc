// SPDX-License-Identifier: MIT
#include "fitting/revolution/sphere_fit.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <variant>
#include <vector>

#include "batten/fitting/statistics.h"
#include "fitting/primitives/algebraic_fits.h"
#include "fitting/primitives/angle_extent.h"
#include "fitting/primitives/surface_minimum.h"
#include "geometry/numeric/constants.h"

namespace batten::internal {
namespace {

constexpr double kTold = 0.7, kToldAtLast = 0.95;

// Share of the sphere that the smallest rectangle about an axis covers, plus a penalty for poles
// amid data. Directions with heights of `told` and beyond do not count for the angle.
double EmptinessOf(const Eigen::Matrix3Xd& directions,
                   const Eigen::Vector3d& axis,
                   double reach,
                   double told) {
  constexpr double kPoleOfData = 0.015;
  const AxisFrame frame = FrameAbout(Eigen::Vector3d::Zero(), axis);
  double low = 1, high = -1;
  std::vector<double> angles;
  for (const auto d : directions.colwise()) {
    const Eigen::Vector3d p = frame.axes.transpose() * d;
    low = std::min(low, p[2]);
    high = std::max(high, p[2]);
    if (std::abs(p[2]) < told) angles.push_back(std::atan2(p[1], p[0]));
  }
  const double swept = kTurn - std::max(0.0, WidestGapOf(angles).width - reach);
  // Half the height of a cap about a pole that random nodes leave empty.
  const double slack = std::min(1.0, reach * reach);
  const int poles = (low < -1 + slack ? 1 : 0) + (high > 1 - slack ? 1 : 0);
  // At the corners of a slice poles cost nothing.
  const bool all_round = swept > 0.99 * kTurn;
  return swept / kTurn * (high - low) / 2 + (all_round ? kPoleOfData * poles : 0);
}

// Steps a direction to neighbours that are better, by ever smaller steps down to `finest`.
template <typename Better>
void Climb(Eigen::Vector3d& best, double first, double finest, const Better& better) {
  for (double step = first; step > finest;) {
    const AxisFrame frame = FrameAbout(Eigen::Vector3d::Zero(), best);
    bool moved = false;
    for (int way = 0; way < 8 && !moved; ++way) {
      const double angle = kTurn * way / 8;
      const Eigen::Vector3d tilt =
          std::cos(angle) * frame.axes.col(0) + std::sin(angle) * frame.axes.col(1);
      const Eigen::Vector3d next = (best + step * tilt).normalized();
      moved = better(next);
      if (moved) best = next;
    }
    if (!moved) step /= 2;
  }
}

// Finds the direction farthest from all others.
Eigen::Vector3d WidestGap(const Eigen::Matrix3Xd& directions) {
  constexpr Eigen::Index kPlaces = 2000;
  const double golden = std::numbers::pi * (3 - std::sqrt(5.0));
  Eigen::Matrix3Xd places(3, kPlaces);  // a spiral over the sphere
  for (Eigen::Index i = 0; i < kPlaces; ++i) {
    const auto at = static_cast<double>(i);
    const double z = 1 - (2 * at + 1) / kPlaces, r = std::sqrt(1 - z * z), angle = golden * at;
    places.col(i) << r * std::cos(angle), r * std::sin(angle), z;
  }
  const std::vector<int> nearest = NeighbourIndex(directions).Nearest(places, 1);
  Eigen::Index widest = 0;
  double distance = 0;
  for (Eigen::Index i = 0; i < kPlaces; ++i) {
    const double own = (directions.col(nearest[i]) - places.col(i)).squaredNorm();
    if (own > distance) {
      distance = own;
      widest = i;
    }
  }
  Eigen::Vector3d best = places.col(widest);
  constexpr double kFirst = 0.04, kFinest = 1e-3;
  Climb(best, kFirst, kFinest, [&](const Eigen::Vector3d& next) {
    const double own = (directions.colwise() - next).colwise().squaredNorm().minCoeff();
    if (own <= distance * (1 + 1e-6)) return false;
    distance = own;
    return true;
  });
  return best;
}

// Minimises the emptiness over axes, from coarse to fine steps.
Eigen::Vector3d Refined(const Eigen::Matrix3Xd& directions, Eigen::Vector3d best, double reach) {
  // The nearer to the poles angles count, the sharper the minimum and the harder to find.
  for (const double told : {kTold, 0.85, kToldAtLast}) {
    double least = EmptinessOf(directions, best, reach, told);
    constexpr double kFirst = 0.1, kFinest = 2e-3, kBetter = 1e-4;
    Climb(best, kFirst, kFinest, [&](const Eigen::Vector3d& next) {
      const double own = EmptinessOf(directions, next, reach, told);
      if (own >= least - kBetter) return false;
      least = own;
      return true;
    });
  }
  return best;
}

}  // namespace

FittedSphere FitSphere(const RevolutionSamples& round, ThreadPool& pool) {
  constexpr int kMostSteps = 20;
  constexpr double kGentle = 1.7;  // of what they leave: Cauchy's weight is a half at 4 deviations
  const double unit = round.size > 0 ? round.size : 1;
  const ShapeData data{(round.nodes().places.colwise() - round.centre) / unit,
                       Eigen::VectorXd::Ones(round.count())};
  FittedSurface shape =
      Minimised(AlgebraicSphereFit(data.points), data, {}, kMostSteps, pool).shape;
  const double scale = RobustScale(SurfaceDistances(shape, data.points, pool));
  if (scale > 0)
    shape = Minimised(shape, data, {Loss::kCauchy, kGentle * scale}, kMostSteps, pool).shape;
  FittedSphere sphere;
  if (!(std::abs(shape.curvature) * kFarAway > 1)) return sphere;
  const auto found = std::get<SphereShape>(shape.Shape(unit, round.centre));
  sphere.centre = found.center;
  sphere.radius = found.radius;
  sphere.misfit = std::abs(shape.curvature) * SurfaceDistances(shape, data.points, pool).norm() /
                  std::sqrt(static_cast<double>(round.count()));
  return sphere;
}

AxisFrame AxisOfSphere(const RevolutionSamples& round, const FittedSphere& sphere) {
  constexpr int kTried = 40;
  constexpr double kClearlyBetter = 0.01;
  const Eigen::Matrix3Xd directions =
      (round.nodes().places.colwise() - sphere.centre).colwise().normalized();
  const PoissonDiskSamples& nodes = round.nodes();
  const double reach = Median({nodes.reach.begin(), nodes.reach.end()}) / sphere.radius;
  const Eigen::Vector3d mean = directions.rowwise().mean();
  const Eigen::Vector3d gap = WidestGap(directions);
  const AxisFrame across = FrameAbout(Eigen::Vector3d::Zero(), gap);
  Eigen::Vector3d slice = gap;
  double least_slice = HUGE_VAL;
  for (int i = 0; i < kTried; ++i) {  // of a slice left out, the axis is across its middle
    const double angle = std::numbers::pi * i / kTried;
    const Eigen::Vector3d axis =
        std::cos(angle) * across.axes.col(0) + std::sin(angle) * across.axes.col(1);
    const double own = EmptinessOf(directions, axis, reach, kTold);
    if (own >= least_slice) continue;
    least_slice = own;
    slice = axis;
  }
  Eigen::Vector3d best = Eigen::Vector3d::UnitZ();
  double least = EmptinessOf(directions, best, reach, kToldAtLast);
  const auto attempt = [&](const Eigen::Vector3d& axis) {
    const double own = EmptinessOf(directions, axis, reach, kToldAtLast);
    if (own >= least - kClearlyBetter) return;
    least = own;
    best = axis;
  };
  attempt(Eigen::Vector3d::UnitY());
  attempt(Eigen::Vector3d::UnitX());
  attempt(Refined(directions, gap, reach));
  attempt(Refined(directions, slice, reach));
  if (mean.norm() > 0) attempt(Refined(directions, mean.normalized(), reach));
  return FrameAbout(sphere.centre, best);
}

}  // namespace batten::internal
