// SPDX-License-Identifier: MIT
// The closest point by distances from convex hulls. Internal to the search for closest points.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "geometry/foot_points/foot_table.h"
#include "geometry/foot_points/found_foot.h"

namespace batten::internal {

// The point of the convex hull of some points that is nearest to the origin, by Wolfe's method.
// [Wolfe 1976, "Finding the nearest point in a polytope"]
class HullPoint {
 public:
  // Points are the columns; stops early where the distance is proved to be at least `enough`.
  HullPoint(const Eigen::Matrix3Xd& points, double enough);

  // A lower bound of the distance, proved by the plane through the point found. Not below zero.
  double lower_bound() const { return bound_; }
  // Its weights: at most four columns, and how much of each.
  int count() const { return count_; }
  int column(int k) const { return columns_[k]; }
  double share(int k) const { return shares_[k]; }

 private:
  bool Project(const Eigen::Matrix3Xd& points);
  void Drop(int k);

  int count_ = 0;
  int columns_[4] = {};
  double shares_[4] = {};
  Eigen::Vector3d at_;
  double bound_ = 0;
};

// Branch and bound, best first: of the cells that are left the one whose control points' hull is
// nearest is halved, after Newton steps from the place that the hull suggests. What a hull misses
// shrinks with the square of a cell, in whatever direction the shape is stretched, so that
// shapes a million times as long as wide need a few hundred cells, where bounds of the squared
// distance (DistanceCertificate) drown in the square of the length. Slower than those elsewhere.
class HullSearch {
 public:
  HullSearch(const FootTable& table, const Eigen::Vector3d& q, const FoundFoot& start);

  // Pieces to look at; others are known to be farther than the start.
  void Add(int piece);

  // The nearest place, and a lower bound that is within the acceptable miss of it unless more cells
  // were needed than allowed.
  FoundFoot Run();

 private:
  struct Cell {
    double bound;  // of the distance
    int piece;
    double x0, x1, y0, y1;
    Eigen::Matrix4Xd net;  // homogeneous Bézier points about q
    double guess_x, guess_y;
  };

  void Push(Cell cell);
  void Halve(const Cell& cell);
  void Descend(int piece, double x, double y);
  double Enough() const;
  bool HalvesFirst(const Cell& cell) const;

  const FootTable& table_;
  Eigen::Vector3d q_;
  FoundFoot best_;
  std::vector<Cell> heap_;
  Eigen::Vector3d per_extent_;
  double left_;  // the least bound of cells given up
};

}  // namespace batten::internal
