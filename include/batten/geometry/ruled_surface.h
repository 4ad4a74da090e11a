// SPDX-License-Identifier: MIT
// Surfaces of straight lines: curves moved along a vector, and lines between two curves.
#pragma once

#include <Eigen/Core>

#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"

namespace batten {

// The general cylinder S(u,v) = C(u) + v·by over the curve's own basis, periodic too, and [0, 1].
// Exact. Throws std::invalid_argument unless `by` is finite, not zero, and not so small that it is
// lost in the coordinates, and where the curve lies on a line along it, so that the surface would
// have no area. [Piegl & Tiller 1997, §8.3]
NurbsSurface Extrude(const NurbsCurve<3>& profile, const Eigen::Vector3d& by);

enum class RuledBy {
  kParameter,  // lines join points at equal shares of both domains: exact
  kLength,  // at equal shares of both lengths: the second curve is retraced, within the tolerance
};

struct RuledOptions {
  RuledBy by = RuledBy::kParameter;
  double tolerance = 0;  // of kLength, in the data's units, above 0
};

struct RuledSurface {
  NurbsSurface surface;
  double error;  // the second edge leaves the second curve by at most that; 0: rounding
};

// The lines from C1 to C2: u along the curves, v = 0 is the first, v = 1 the second; degrees and
// knots are made common, and weights stay those of each curve, so that both edges are exact. With
// kLength the second edge is a cubic that runs at the pace of the first curve. A curve that is a
// point makes a cone. Throws std::invalid_argument where one curve is closed and the other not, or
// both are one or on one line, and for kLength where one has no length. [Piegl & Tiller 1997, §8.4]
RuledSurface Ruled(const NurbsCurve<3>& first,
                   const NurbsCurve<3>& second,
                   const RuledOptions& options = {});

}  // namespace batten
