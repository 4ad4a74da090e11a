// SPDX-License-Identifier: MIT
// The Coons map from the unit square to a plane region between four curves, and its inverse.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>

#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/thread_pool.h"

namespace batten::internal {

// The sides of a region of the plane, each over its own interval and in the direction in which the
// square's parameter rises: `lower_v` and `upper_v` are t = 0 and t = 1, along s; `lower_u` and
// `upper_u` are s = 0 and s = 1, along t.
struct PlaneSides {
  NurbsCurve<2> lower_v, upper_v, lower_u, upper_u;
  // Sides, in that order, whose ends stay fixed unless both sides at a corner are held
  std::array<bool, 4> held = {false, false, false, false};
};

// X(s,t), the bilinearly blended patch over the four sides [Coons 1967], its inverse, and a test of
// injectivity. Beyond the square the sides are continued straight.
class FourSidedMap {
 public:
  // Sides that do not meet at a corner are moved to the held one, or to the middle of the gap; the
  // move falls linearly along each side.
  explicit FourSidedMap(const PlaneSides& sides);

  struct Jet {
    Eigen::Vector2d point, ds, dt;
  };
  Jet At(double s, double t) const;

  // Whether the Jacobian S_s × S_t has one sign over the square and stays away from zero.
  bool one_to_one() const { return one_to_one_; }

  // (s,t) of a point by Newton's method; none where it does not converge within one square's size
  // of the square.
  std::optional<Eigen::Vector2d> Invert(const Eigen::Vector2d& point) const;

  // Inverts every column; a point without an inverse gets the nearest place of a coarse grid.
  Eigen::Matrix2Xd Inverted(const Eigen::Matrix2Xd& points, ThreadPool& pool) const;

  // Mean lengths of the sides along s, and along t.
  double length_s() const { return length_s_; }
  double length_t() const { return length_t_; }

 private:
  // A side over [0, 1] with the displacements of its ends.
  struct Side {
    NurbsCurve<2> curve;
    Eigen::Vector2d at_start = Eigen::Vector2d::Zero(), at_end = Eigen::Vector2d::Zero();

    // The point and the derivative, extrapolated linearly beyond the ends.
    Eigen::Matrix2d At(double s) const;
    void MoveEnds(const Eigen::Vector2d& start, const Eigen::Vector2d& end);
  };

  static constexpr int kGrid = 32, kTiles = 48;

  void CheckFolds();
  void FindStarts();
  Eigen::Index NearestNodeIndex(const Eigen::Vector2d& point) const;
  static Eigen::Vector2d NodePlace(Eigen::Index node);  // (s,t)
  Eigen::Index Start(const Eigen::Vector2d& point) const;
  std::optional<Eigen::Vector2d> InvertFrom(Eigen::Index node, const Eigen::Vector2d& point) const;

  Side lower_v_, upper_v_, lower_u_, upper_u_;
  Eigen::Matrix2d corners_low_, corners_high_;  // columns: s = 0, s = 1; at t = 0, at t = 1
  Eigen::Matrix2Xd nodes_;                      // of a grid of (kGrid + 1)² places
  Eigen::Matrix4Xd slopes_;                     // the derivatives at the nodes: S_s above S_t
  Eigen::Vector2d low_, tile_;  // tiles over the nodes' box: its corner, their sides
  Eigen::ArrayXXi starts_;      // the node nearest to a tile's middle
  double length_s_ = 0, length_t_ = 0;
  bool one_to_one_ = false;
};

}  // namespace batten::internal
