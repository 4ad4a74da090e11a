// SPDX-License-Identifier: MIT
// Whether a surface stays near to a plane over a triangle of its domain, or near to a line over a
// segment, for certain. Internal to geometry.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "batten/geometry/nurbs_surface.h"

namespace batten::internal {

// Over every box of parameters in one cell between knots the surface lies in the hull of the Bézier
// points of that part, whatever the weights: so n·S − c lies between the least and the greatest
// n·P − c of these points. Boxes are halved where that is not enough, those beside the triangle
// left out; the bounds close in with the square of the boxes' size.
// Spans that together, one after the other, are shorter than 2^-28 of the domain are left out: no
// triangle has room in them.
// [hulls and subdivision: Lane & Riesenfeld 1980]
class TriangleProof {
 public:
  // Keeps a copy of what it needs: 32 bytes for each Bézier point, up to 256 MB.
  explicit TriangleProof(const NurbsSurface& surface);

  // None where |n·S − c| ≤ tolerance is proven over the triangle, with n of length one; else a
  // place of the triangle where it does not hold, or could not be proven with a few hundred boxes.
  // Of a triangle without area nothing is proven.
  std::optional<Eigen::Vector2d> OffPlane(const std::array<Eigen::Vector2d, 3>& corners,
                                          const Eigen::Vector3d& normal,
                                          double offset,
                                          double tolerance);

  // The same for the distance from the line through `point` along the unit vector `direction` over
  // a segment between two parameters.
  std::optional<Eigen::Vector2d> OffLine(const Eigen::Vector2d& from,
                                         const Eigen::Vector2d& to,
                                         const Eigen::Vector3d& point,
                                         const Eigen::Vector3d& direction,
                                         double tolerance);

 private:
  struct Axis {
    std::vector<int> spans;                 // without slivers
    std::vector<double> lower, upper;       // of the spans
    std::vector<Eigen::MatrixXd> matrices;  // to Bézier points
    explicit Axis(const SplineBasis& basis);
    // The spans [first, last) with which the interval has more than an end in common; where it is
    // a point, one that holds it.
    std::pair<int, int> Meeting(double from, double to) const;
  };
  struct Box {
    Eigen::Array2d lower, upper;
    std::size_t at;  // of its coefficients in boxes_: those of f, then those of w
  };

  const Eigen::Matrix4Xd& PointsOf(int cell_u, int cell_v);
  Eigen::Matrix4Xd MadePoints(int cell_u, int cell_v) const;
  void Halve(const Box& box, int direction);
  std::optional<Eigen::Vector2d> Search(const std::array<Eigen::Vector2d, 3>& corners,
                                        double tolerance);

  NurbsSurface surface_;
  int p_, q_;
  Axis u_, v_;
  bool kept_;                             // whether there is room for all cells
  std::vector<Eigen::Matrix4Xd> points_;  // of cells, v fastest; empty until asked for
  Eigen::Matrix4Xd made_;
  std::vector<Box> waiting_;
  std::vector<double> boxes_, ratios_;
  int left_ = 0;  // boxes that may still be halved
};

}  // namespace batten::internal
