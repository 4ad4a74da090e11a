// SPDX-License-Identifier: MIT
// How far a surface can be off a plane over a triangle of its domain, for certain. Internal to
// geometry.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "batten/geometry/nurbs_surface.h"

namespace batten {

// Spans shorter than this share of the domain hold no triangle: they count as jumps of the knots'
// derivatives, that is, creases where the knots on both their sides are together as many as the
// degree.
inline constexpr double kSliverShare = 0x1p-28;

// With the plane n·x = c through three points of the surface, f = w (n·S − c) is a polynomial on
// every cell between knots that vanishes at the triangle's corners: half its second derivatives
// bound it between them, and those lie between the least and the greatest of their Bernstein
// coefficients. Cells are halved where that is not near enough, down to the size of the triangle,
// and the halves kept for the next triangles, up to some 256 MB.
// [the remainder: Filip, Magedson & Markot 1986; the coefficients: Lane & Riesenfeld 1980]
class FlatnessBound {
 public:
  explicit FlatnessBound(const NurbsSurface& surface);

  struct Result {
    double distance;              // |n·S − c| is at most that over the triangle
    std::array<double, 3> bends;  // what the edges, opposite the corners, have of it
  };

  // Over the triangle, whose three corners have n·S = c; two equal corners are a segment. The
  // surface's first derivatives must have no jump inside. Stops as soon as the distance is at most
  // `enough`.
  Result Over(const std::array<Eigen::Vector2d, 3>& corners,
              const Eigen::Vector3d& normal,
              double offset,
              double enough);

 private:
  // A part of a cell: its Bézier points (wP, w) and the second derivatives' coefficients.
  struct Node {
    Eigen::Array2d lower, upper;
    Eigen::Matrix4Xd points;
    std::array<Eigen::Matrix4Xd, 3> seconds;  // along uu, uv, vv
    double least_weight;
    int first_half = -1;  // the other follows it
  };
  struct Range {
    double low, high;
  };

  Node NodeOf(Eigen::Array2d lower, Eigen::Array2d upper, Eigen::Matrix4Xd points) const;
  bool Halve(int node, int direction);
  void Cover(const Eigen::Array2d& lower, const Eigen::Array2d& upper);
  Result BoundOver(const std::array<Eigen::Vector2d, 3>& corners,
                   const Eigen::Array2d& size,
                   const Eigen::Vector4d& plane) const;

  int p_, q_;
  std::vector<double> breaks_u_, breaks_v_;  // where cells begin, and the end; slivers in them
  std::vector<Node> nodes_;                  // the cells first, v fastest
  std::size_t most_nodes_;
  std::vector<int> cover_, finer_;  // of the triangle at hand
};

}  // namespace batten
