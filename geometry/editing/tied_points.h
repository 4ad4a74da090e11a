// SPDX-License-Identifier: MIT
// Control points that are one point of the shape and are to stay one.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "batten/geometry/direction.h"
#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"
#include "geometry/editing/control_forms.h"

namespace batten::internal {

// Which distinct control points (control_forms.h) coincide, to kCloses of the net's size, because
// the shape closes over a clamped basis or an edge of it is a point. What moves them moves them
// together and counts them once, as it does the copies over a periodic basis.
class TiedPoints {
 public:
  enum class Of { kSeams, kSeamsAndPoles };

  template <int Dim>
  explicit TiedPoints(const NurbsCurve<Dim>& curve);
  explicit TiedPoints(const NurbsSurface& surface, Of what = Of::kSeamsAndPoles);

  // The one that stands for all those tied to it.
  Eigen::Index First(Eigen::Index k) const;
  ControlForm Together(const ControlForm& form) const;

  // Moves (a column for each distinct control point) with those of the first for all tied to it.
  Eigen::MatrixXd Spread(Eigen::MatrixXd moves) const;

  // Whether both ends of the direction are tied, of a curve of kU.
  bool closed(Direction direction) const {
    return direction == Direction::kU ? closed_u_ : closed_v_;
  }

 private:
  void Tie(Eigen::Index a, Eigen::Index b);

  std::vector<Eigen::Index> first_;  // itself, or one before it that is tied to it
  bool closed_u_ = false, closed_v_ = false;
};

}  // namespace batten::internal
