// SPDX-License-Identifier: MIT
#include "fitting/outline/four_sided_map.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "batten/geometry/arc_length.h"
#include "fitting/core/rounding.h"

namespace batten::internal {
namespace {

constexpr double kLeastJacobian = 0.1;  // of the mean Jacobian; below: not one-to-one
constexpr int kSteps = 30;
constexpr double kFarthestFromSides = 2;  // from the square's middle, in its sides

}  // namespace

Eigen::Matrix2d FourSidedMap::Side::At(double s) const {
  const double a = curve.basis().lower(), b = curve.basis().upper();
  const double inside = std::clamp(s, 0.0, 1.0);
  const CurveJet<2> jet = curve.JetAt(a + inside * (b - a));
  Eigen::Matrix2d result;
  result.col(1) = (b - a) * jet.first + at_end - at_start;
  result.col(0) =
      jet.point + (1 - inside) * at_start + inside * at_end + (s - inside) * result.col(1);
  return result;
}

void FourSidedMap::Side::MoveEnds(const Eigen::Vector2d& start, const Eigen::Vector2d& end) {
  at_start = start - curve.At(curve.basis().lower());
  at_end = end - curve.At(curve.basis().upper());
}

FourSidedMap::FourSidedMap(const PlaneSides& sides)
    : lower_v_{sides.lower_v},
      upper_v_{sides.upper_v},
      lower_u_{sides.lower_u},
      upper_u_{sides.upper_u} {
  // Joins a side along s and one along t at their corner.
  const auto corner =
      [](const Side& a, bool a_held, double s, const Side& b, bool b_held, double t) {
        const double share = a_held == b_held ? 0.5 : a_held ? 1.0 : 0.0;
        return Eigen::Vector2d(share * a.At(s).col(0) + (1 - share) * b.At(t).col(0));
      };
  const auto& [bottom, top, left, right] = sides.held;
  corners_low_.col(0) = corner(lower_v_, bottom, 0, lower_u_, left, 0);
  corners_low_.col(1) = corner(lower_v_, bottom, 1, upper_u_, right, 0);
  corners_high_.col(0) = corner(upper_v_, top, 0, lower_u_, left, 1);
  corners_high_.col(1) = corner(upper_v_, top, 1, upper_u_, right, 1);
  lower_v_.MoveEnds(corners_low_.col(0), corners_low_.col(1));
  upper_v_.MoveEnds(corners_high_.col(0), corners_high_.col(1));
  lower_u_.MoveEnds(corners_low_.col(0), corners_high_.col(0));
  upper_u_.MoveEnds(corners_low_.col(1), corners_high_.col(1));
  length_s_ = (ArcLength(sides.lower_v) + ArcLength(sides.upper_v)) / 2;
  length_t_ = (ArcLength(sides.lower_u) + ArcLength(sides.upper_u)) / 2;
  CheckFolds();
  FindStarts();
}

FourSidedMap::Jet FourSidedMap::At(double s, double t) const {
  const Eigen::Matrix2d below = lower_v_.At(s), above = upper_v_.At(s), left = lower_u_.At(t),
                        right = upper_u_.At(t);
  const Eigen::Vector2d low = (1 - s) * corners_low_.col(0) + s * corners_low_.col(1);
  const Eigen::Vector2d high = (1 - s) * corners_high_.col(0) + s * corners_high_.col(1);
  const Eigen::Vector2d low_step = corners_low_.col(1) - corners_low_.col(0);
  const Eigen::Vector2d high_step = corners_high_.col(1) - corners_high_.col(0);
  Jet jet;
  jet.point = (1 - t) * (below.col(0) - low) + t * (above.col(0) - high) + (1 - s) * left.col(0) +
              s * right.col(0);
  jet.ds = (1 - t) * (below.col(1) - low_step) + t * (above.col(1) - high_step) + right.col(0) -
           left.col(0);
  jet.dt = (above.col(0) - high) - (below.col(0) - low) + (1 - s) * left.col(1) + s * right.col(1);
  return jet;
}

void FourSidedMap::CheckFolds() {
  nodes_.resize(2, (kGrid + 1) * (kGrid + 1));
  slopes_.resize(4, nodes_.cols());
  Eigen::VectorXd areas(nodes_.cols());
  for (Eigen::Index node = 0; node < nodes_.cols(); ++node) {
    const Eigen::Vector2d place = NodePlace(node);
    const Jet jet = At(place[0], place[1]);
    nodes_.col(node) = jet.point;
    slopes_.col(node) << jet.ds, jet.dt;
    areas[node] = jet.ds[0] * jet.dt[1] - jet.ds[1] * jet.dt[0];
  }
  const double mean = areas.mean(), least = mean > 0 ? areas.minCoeff() : -areas.maxCoeff();
  one_to_one_ = mean != 0 && least >= kLeastJacobian * std::abs(mean);
}

void FourSidedMap::FindStarts() {
  low_ = nodes_.rowwise().minCoeff();
  tile_ =
      ((nodes_.rowwise().maxCoeff() - low_) / kTiles).cwiseMax(std::numeric_limits<double>::min());
  starts_.resize(kTiles, kTiles);
  for (int i = 0; i < kTiles; ++i) {
    for (int j = 0; j < kTiles; ++j) {
      const Eigen::Vector2d middle = low_ + Eigen::Vector2d(i + 0.5, j + 0.5).cwiseProduct(tile_);
      starts_(j, i) = static_cast<int>(NearestNodeIndex(middle));
    }
  }
}

Eigen::Index FourSidedMap::NearestNodeIndex(const Eigen::Vector2d& point) const {
  Eigen::Index nearest = 0;
  (nodes_.colwise() - point).colwise().squaredNorm().minCoeff(&nearest);
  return nearest;
}

Eigen::Vector2d FourSidedMap::NodePlace(Eigen::Index node) {
  return Eigen::Vector2d(static_cast<double>(node / (kGrid + 1)),
                         static_cast<double>(node % (kGrid + 1))) /
         kGrid;
}

// A node near a place.
Eigen::Index FourSidedMap::Start(const Eigen::Vector2d& point) const {
  const Eigen::Array2d tile =
      ((point - low_).array() / tile_.array()).floor().max(0.0).min(kTiles - 1.0);
  return starts_(static_cast<int>(tile[1]), static_cast<int>(tile[0]));
}

std::optional<Eigen::Vector2d> FourSidedMap::InvertFrom(Eigen::Index node,
                                                        const Eigen::Vector2d& point) const {
  Eigen::Vector2d at = NodePlace(node);
  for (int step = 0; step < kSteps; ++step) {
    const Jet jet =
        step > 0 ? At(at[0], at[1])
                 : Jet{nodes_.col(node), slopes_.col(node).head<2>(), slopes_.col(node).tail<2>()};
    Eigen::Matrix2d slope;
    slope << jet.ds, jet.dt;
    const Eigen::Vector2d move = slope.inverse() * (point - jet.point);
    if (!move.allFinite()) return std::nullopt;
    at += move.cwiseMax(-0.5).cwiseMin(0.5);
    if ((at.array() - 0.5).abs().maxCoeff() > kFarthestFromSides) return std::nullopt;
    if (move.cwiseAbs().maxCoeff() < kRelativelyEqual) return at;  // in sides of the square
  }
  return std::nullopt;
}

std::optional<Eigen::Vector2d> FourSidedMap::Invert(const Eigen::Vector2d& point) const {
  const std::optional<Eigen::Vector2d> found = InvertFrom(Start(point), point);
  return found ? found : InvertFrom(NearestNodeIndex(point), point);
}

Eigen::Matrix2Xd FourSidedMap::Inverted(const Eigen::Matrix2Xd& points, ThreadPool& pool) const {
  Eigen::Matrix2Xd places(2, points.cols());
  pool.For(points.cols(), 512, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (std::ptrdiff_t k = begin; k < end; ++k) {
      const std::optional<Eigen::Vector2d> found = Invert(points.col(k));
      places.col(k) = found ? *found : NodePlace(NearestNodeIndex(points.col(k)));
    }
  });
  return places;
}

}  // namespace batten::internal
