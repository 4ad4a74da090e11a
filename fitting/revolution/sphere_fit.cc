// SPDX-License-Identifier: MIT
#include "fitting/revolution/sphere_fit.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "batten/fitting/statistics.h"
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
  constexpr int kParts = 512;  // of the circle, with the first and last angle in each
  std::vector<double> first(kParts, HUGE_VAL), last(kParts, -HUGE_VAL);
  for (const auto d : directions.colwise()) {
    const Eigen::Vector3d p = frame.axes.transpose() * d;
    low = std::min(low, p[2]);
    high = std::max(high, p[2]);
    if (std::abs(p[2]) >= told) continue;
    const double angle = std::atan2(p[1], p[0]) + kTurn / 2;
    const int part = std::clamp(static_cast<int>(angle / kTurn * kParts), 0, kParts - 1);
    first[part] = std::min(first[part], angle);
    last[part] = std::max(last[part], angle);
  }
  double gap = 0, start = HUGE_VAL, before = HUGE_VAL;
  for (int part = 0; part < kParts; ++part) {
    if (first[part] > last[part]) continue;
    if (start == HUGE_VAL) {
      start = first[part];
    } else {
      gap = std::max(gap, first[part] - before);
    }
    before = last[part];
  }
  if (start < HUGE_VAL) gap = std::max(gap, start + kTurn - before);
  const double swept = kTurn - std::max(0.0, gap - reach);
  // Half the height of a cap about a pole that random nodes leave empty.
  const double slack = std::min(1.0, reach * reach);
  const int poles = (low < -1 + slack ? 1 : 0) + (high > 1 - slack ? 1 : 0);
  // At the corners of a slice poles cost nothing.
  const bool all_round = swept > 0.99 * kTurn;
  return swept / kTurn * (high - low) / 2 + (all_round ? kPoleOfData * poles : 0);
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
  constexpr double kFinest = 1e-3;
  for (double step = 0.04; step > kFinest;) {
    const AxisFrame frame = FrameAbout(Eigen::Vector3d::Zero(), best);
    bool moved = false;
    for (int way = 0; way < 8 && !moved; ++way) {
      const double angle = kTurn * way / 8;
      const Eigen::Vector3d tilt =
          std::cos(angle) * frame.axes.col(0) + std::sin(angle) * frame.axes.col(1);
      const Eigen::Vector3d next = (best + step * tilt).normalized();
      const double own = (directions.colwise() - next).colwise().squaredNorm().minCoeff();
      if (own <= distance * (1 + 1e-6)) continue;
      distance = own;
      best = next;
      moved = true;
    }
    if (!moved) step /= 2;
  }
  return best;
}

// Minimises the emptiness over axes, from coarse to fine steps.
class AxisSearch {
 public:
  AxisSearch(const Eigen::Matrix3Xd& directions, double reach)
      : directions_(directions), reach_(reach) {}

  double Of(const Eigen::Vector3d& axis, double told) const {
    return EmptinessOf(directions_, axis, reach_, told);
  }

  Eigen::Vector3d Refined(Eigen::Vector3d best) const {
    // The nearer to the poles angles count, the sharper the minimum and the harder to find.
    for (const double told : {kTold, 0.85, kToldAtLast}) {
      double least = Of(best, told);
      constexpr double kFinest = 2e-3, kBetter = 1e-4;
      for (double step = 0.1; step > kFinest;) {
        const AxisFrame frame = FrameAbout(Eigen::Vector3d::Zero(), best);
        bool moved = false;
        for (int way = 0; way < 8 && !moved; ++way) {
          const double angle = kTurn * way / 8;
          const Eigen::Vector3d tilt =
              std::cos(angle) * frame.axes.col(0) + std::sin(angle) * frame.axes.col(1);
          const Eigen::Vector3d next = (best + step * tilt).normalized();
          const double own = Of(next, told);
          if (own >= least - kBetter) continue;
          least = own;
          best = next;
          moved = true;
        }
        if (!moved) step /= 2;
      }
    }
    return best;
  }

 private:
  const Eigen::Matrix3Xd& directions_;
  double reach_;
};

}  // namespace

FittedSphere FitSphere(const RevolutionSamples& round) {
  const Eigen::Index n = round.count();
  const double unit = round.size > 0 ? round.size : 1;
  const Eigen::Matrix3Xd p = (round.nodes().places.colwise() - round.centre) / unit;
  Eigen::VectorXd weights = Eigen::VectorXd::Ones(n), off(n);
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  double radius = 0;
  // |p|² = 2 p·c + (R² − |c|²) to start with.
  {
    Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
    Eigen::Vector4d right = Eigen::Vector4d::Zero(), row;
    for (const auto q : p.colwise()) {
      row << 2 * q, 1;
      normal += row * row.transpose();
      right += row * q.squaredNorm();
    }
    normal.diagonal().array() += 1e-12 * static_cast<double>(n);
    const Eigen::Vector4d c = normal.ldlt().solve(right);
    centre = c.head<3>();
    radius = std::sqrt(std::max(0.0, c[3] + centre.squaredNorm()));
  }
  constexpr int kRounds = 12;
  constexpr double kCauchy = 4, kFarAway = 1e3;
  for (int step = 0; step < kRounds; ++step) {
    Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
    Eigen::Vector4d right = Eigen::Vector4d::Zero(), row;
    for (Eigen::Index i = 0; i < n; ++i) {
      const Eigen::Vector3d out = p.col(i) - centre;
      const double distance = out.norm();
      off[i] = distance - radius;
      if (distance > 0) {
        row << out / distance, 1;
      } else {
        row << 0, 0, 0, 1;
      }
      normal += weights[i] * row * row.transpose();
      right += weights[i] * off[i] * row;
    }
    normal.diagonal().array() += 1e-12 * weights.sum();
    const Eigen::Vector4d move = normal.ldlt().solve(right);
    if (!move.allFinite()) break;
    centre += move.head<3>();
    radius += move[3];
    const Eigen::VectorXd sizes = off.cwiseAbs();
    const double scale = kMadToSigma * Median({sizes.begin(), sizes.end()});
    if (scale > 0) weights = (1 + (off / (kCauchy * scale)).array().square()).inverse();
  }
  FittedSphere sphere;
  if (!centre.allFinite() || !(radius > 0) || radius > kFarAway) return sphere;
  const Eigen::VectorXd final_off =
      ((p.colwise() - centre).colwise().norm().array() - radius).matrix().transpose();
  sphere.centre = round.centre + unit * centre;
  sphere.radius = unit * radius;
  sphere.misfit = std::sqrt(final_off.squaredNorm() / static_cast<double>(n)) / radius;
  return sphere;
}

AxisFrame AxisOfSphere(const RevolutionSamples& round, const FittedSphere& sphere) {
  constexpr int kTried = 40;
  constexpr double kClearlyBetter = 0.01;
  const Eigen::Matrix3Xd directions =
      (round.nodes().places.colwise() - sphere.centre).colwise().normalized();
  const PoissonDiskSamples& nodes = round.nodes();
  const double reach = Median({nodes.reach.begin(), nodes.reach.end()}) / sphere.radius;
  const AxisSearch search(directions, reach);
  const Eigen::Vector3d mean = directions.rowwise().mean();
  const Eigen::Vector3d gap = WidestGap(directions);
  const AxisFrame across = FrameAbout(Eigen::Vector3d::Zero(), gap);
  Eigen::Vector3d slice = gap;
  double least_slice = HUGE_VAL;
  for (int i = 0; i < kTried; ++i) {  // of a slice left out, the axis is across its middle
    const double angle = std::numbers::pi * i / kTried;
    const Eigen::Vector3d axis =
        std::cos(angle) * across.axes.col(0) + std::sin(angle) * across.axes.col(1);
    const double own = search.Of(axis, kTold);
    if (own >= least_slice) continue;
    least_slice = own;
    slice = axis;
  }
  Eigen::Vector3d best = Eigen::Vector3d::UnitZ();
  double least = search.Of(best, kToldAtLast);
  const auto attempt = [&](const Eigen::Vector3d& axis) {
    const double own = search.Of(axis, kToldAtLast);
    if (own >= least - kClearlyBetter) return;
    least = own;
    best = axis;
  };
  attempt(Eigen::Vector3d::UnitY());
  attempt(Eigen::Vector3d::UnitX());
  attempt(search.Refined(gap));
  attempt(search.Refined(slice));
  if (mean.norm() > 0) attempt(search.Refined(mean.normalized()));
  return FrameAbout(sphere.centre, best);
}

}  // namespace batten::internal
