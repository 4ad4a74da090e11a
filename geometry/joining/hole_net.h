// SPDX-License-Identifier: MIT
// The control points of patches round the centre of a hole, shared ones once.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"
#include "batten/geometry/spline_basis.h"

namespace batten::internal {

// Patch i of n, over one basis in u and v: (0, 0) is the centre, (1, 0) the middle of side i, (1,
// 1) the corner where side i begins, (0, 1) the middle of side i − 1. Its row v = 0 is the column
// u = 0 of patch i + 1. Control points on the sides are given, the others unknown; all are counted
// from the middle of the given ones, so that far from the origin no digits are lost.
class HoleNet {
 public:
  // `sides[i]` begins at corner i: splines of 2·spans spans.
  HoleNet(const std::vector<NurbsCurve<3>>& sides, int spans);

  int sides() const { return sides_; }
  int size() const { return basis_.size(); }  // of a patch, in each direction
  const SplineBasis& basis() const { return basis_; }
  int unknowns() const { return unknowns_; }

  // The number of a control point among the unknowns; −1 − k for the given point k.
  int Index(int patch, int i, int j) const;
  Eigen::Vector3d Given(int index) const { return given_.col(-1 - index); }

  std::vector<NurbsSurface> Patches(const Eigen::Matrix3Xd& unknowns) const;

 private:
  int sides_, unknowns_;
  SplineBasis basis_;
  Eigen::Vector3d origin_;
  Eigen::Matrix3Xd given_;  // side by side: 2·size − 1 points each, from its start to its end
};

}  // namespace batten::internal
