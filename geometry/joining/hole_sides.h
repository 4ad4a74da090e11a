// SPDX-License-Identifier: MIT
// The sides of a hole in order, each as a spline of its arc length.
#pragma once

#include <vector>

#include "batten/geometry/arc_length.h"
#include "batten/geometry/fill_side.h"

namespace batten::internal {

// A side run in the loop's sense by its share of length s in [0, 1].
class HoleSide {
 public:
  HoleSide(const FillSide& side, bool reversed);

  Eigen::Vector3d At(double s) const;
  // The unit normal of the neighbour there, and its direction out of itself, into the hole,
  // perpendicular to the edge; none without a neighbour or where it has no normal.
  struct Plane {
    Eigen::Vector3d normal, outwards;
  };
  std::optional<Plane> PlaneAt(double s) const;
  // The unit tangent, in the loop's sense; zero where the curve rests.
  Eigen::Vector3d TangentAt(double s) const;

  // The quintic spline of 2·spans equal spans on [0, 1] nearest to it that meets its ends.
  NurbsCurve<3> Spline(int spans, const Eigen::Vector3d& start, const Eigen::Vector3d& end) const;

 private:
  double ParameterAt(double s) const;

  FillSide side_;
  bool reversed_;
  ArcLengthMap length_;
};

// One loop: each side ends where the next begins, within the tolerance. Throws
// std::invalid_argument where they make none.
std::vector<HoleSide> OrderedSides(const std::vector<FillSide>& sides, double tolerance);

}  // namespace batten::internal
