// SPDX-License-Identifier: MIT
// The loops that trim a surface as curves in space, for the search of closest points. Internal.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "batten/geometry/nurbs_surface.h"
#include "geometry/editing/monotone_arcs.h"
#include "geometry/foot_points/foot_table.h"

namespace batten::internal {

// c(t) = S(u(t), v(t)) along every loop, cut where loop or surface have knots and where u or v turn
// back, so that each part is smooth; a part is halved until the quintic with its ends' points,
// first and second derivatives is as near as wanted: 1e-12 of the surface's size, or rounding. The
// error of such a quintic is t³(1−t)³ c⁽⁶⁾/720: it falls by 64 with every halving, and is measured
// at three places between the ends and doubled. O(parts · p²).
class LoopCurves {
 public:
  // A trimmed surface, whose points are relative to `middle` inside; `size` is what deviations are
  // relative to.
  LoopCurves(const NurbsSurface& surface, const Eigen::Vector3d& middle, double size);

  // One quintic a part.
  FootTable Table() const { return FootTable(curves_, middle_); }

  // The distance that a point of a loop has at least, for one that is so far from the curves at
  // least, by their deviations; of parts that are not followed closely, by the boxes that hold
  // them.
  double LowerBound(const Eigen::Vector3d& q, double from_curves) const;

  // The surface's parameters at local x in [−1, 1] of a part.
  Eigen::Vector2d At(int part, double x) const;

 private:
  class Builder;
  struct Part {
    int arc;
    double t0, t1;
  };

  UnitDomain domain_;
  Eigen::Vector3d middle_;
  std::vector<MonotoneArc> arcs_;
  std::vector<Part> parts_;
  std::vector<Eigen::Matrix3Xd> curves_;
  double deviation_ = 0;  // of all parts but those that halving does not bring to follow their loop
  std::vector<Eigen::AlignedBox3d> loose_;  // these, grown by their deviations
};

}  // namespace batten::internal
