// SPDX-License-Identifier: MIT
// Where points lie against smoothed borders.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "batten/geometry/thread_pool.h"
#include "fitting/outline/outline_spline.h"

namespace batten::internal {

// A point near a border, or outside far from any (loop −1).
struct OutlineFootPoint {
  Eigen::Index point;
  int loop;
  double t;                 // the parameter of the nearest place
  double outside;           // the distance, negative inside
  Eigen::Vector2d outward;  // of length one
};

// Polygons along splines, in a grid.
class OutlinePolygon {
 public:
  // Points up to `reach` from a border are looked at exactly; sides leave it by `sagitta` at most.
  OutlinePolygon(const std::vector<OutlineSpline>& loops, double reach, double sagitta = 0.002);

  struct Vertex {
    double t;
    Eigen::Vector2d place;
  };
  const std::vector<std::vector<Vertex>>& vertices() const { return vertices_; }

  // Of the points at most `reach` inside, and all outside, in their order. O(m).
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

  double reach_, side_;
  Eigen::Vector2d corner_;
  std::int64_t nu_, nv_;
  std::vector<std::vector<Vertex>> vertices_;  // the last one is the first
  std::vector<Segment> segments_;
  std::vector<std::int64_t> begin_;  // of a cell's segments
  std::vector<int> entries_;
  std::vector<char> inside_;  // of a cell without segments
};

}  // namespace batten::internal
