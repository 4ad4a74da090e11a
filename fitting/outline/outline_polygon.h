// SPDX-License-Identifier: MIT
// Foot points and signed distances of points to smoothed outlines.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "batten/geometry/thread_pool.h"
#include "fitting/outline/outline_spline.h"

namespace batten::internal {

// The foot point of a point near a border; loop −1 for a point outside, far from any border.
struct OutlineFootPoint {
  Eigen::Index point;
  int loop;
  double t;                 // the parameter of the nearest place
  double outside;           // the distance, negative inside
  Eigen::Vector2d outward;  // of length one
};

// Polygons that approximate the splines, indexed by a grid.
class OutlinePolygon {
 public:
  // Points up to `reach` from a border get exact foot points; the polygon deviates from the spline
  // by `sagitta` at most.
  OutlinePolygon(const std::vector<OutlineSpline>& loops, double reach, double sagitta = 0.002);

  struct Vertex {
    double t;
    Eigen::Vector2d place;
  };
  const std::vector<std::vector<Vertex>>& vertices() const { return vertices_; }

  // Foot points of all points outside and of those at most `reach` inside, in their order. O(m).
  std::vector<OutlineFootPoint> FootPointSet(const Eigen::Matrix2Xd& points,
                                             ThreadPool& pool) const;

 private:
  struct Segment {
    int loop;
    size_t first;
  };
  void Enter();
  void MarkInside();
  OutlineFootPoint FootOf(const Eigen::Vector2d& point, std::int64_t cell) const;
  bool IsInside(const Eigen::Vector2d& point, std::int64_t cell) const;

  double reach_, side_;
  Eigen::Vector2d corner_;
  std::int64_t nu_, nv_;
  std::vector<std::vector<Vertex>> vertices_;  // the last one is the first
  std::vector<Segment> segments_;
  std::vector<std::int64_t> begin_;  // of a cell's segments
  std::vector<int> entries_;
  std::vector<char> inside_;  // whether a cell's middle is
};

}  // namespace batten::internal
