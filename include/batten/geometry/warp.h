// SPDX-License-Identifier: MIT
// Changes of shape within a region along a direction.
#pragma once

#include <Eigen/Core>

#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"
#include "batten/geometry/parameter_range.h"

namespace batten {

// How far a warp goes along its direction: 0 at both ends of the range, 1 in its middle.
enum class WarpShape {
  kBump,     // the cubic B-spline over four equal spans: C²
  kTent,     // two straight lines
  kPlateau,  // rises over the first third, falls over the last, by the quintic that is C² there
};

struct WarpOptions {
  WarpShape shape = WarpShape::kBump;
  int spans = 16;  // 4 … 1000 at least in each range: knots are inserted for as many
};

// The shape with its control points within the region moved along `by`, each by the share that the
// warp's shape has at its Greville abscissa (on surfaces the product of both). Knots are inserted
// first, so that there are enough; control points that act outside the region too stay, and the
// shape with them, to the rounding of the insertion. In the middle of the region the shape is moved
// by `by` exactly; elsewhere, without weights, by a spline between 0 and 1 that tends to the warp's
// shape with the square of the knots' distance. Throws std::invalid_argument where a range is
// empty or leaves the domain, `by` is not finite, or no direction of the region is given.
// [Piegl & Tiller 1997, §11.4.1]
template <int Dim>
NurbsCurve<Dim> Warped(const NurbsCurve<Dim>& curve,
                       const ParameterRange& range,
                       const Eigen::Matrix<double, Dim, 1>& by,
                       const WarpOptions& options = {});
NurbsSurface Warped(const NurbsSurface& surface,
                    const ParameterRegion& region,
                    const Eigen::Vector3d& by,
                    const WarpOptions& options = {});

}  // namespace batten
