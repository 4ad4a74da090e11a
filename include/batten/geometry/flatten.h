// SPDX-License-Identifier: MIT
// Regions of a shape flattened to a plane.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"
#include "batten/geometry/parameter_range.h"

namespace batten {

// The plane, of plane curves the line, to which a region is flattened: normal·x = offset.
template <int Dim>
struct FlattenOptions {
  Eigen::Matrix<double, Dim, 1> normal = Eigen::Matrix<double, Dim, 1>::Unit(Dim - 1);
  double offset = 0;
  // Points go to the plane in this direction; along the normal when absent.
  std::optional<Eigen::Matrix<double, Dim, 1>> along = std::nullopt;
  // How far beyond the region, in shares of its range, the shape may change; > 0.
  double transition = 0.1;
};

// The shape that lies in the plane over the whole region, to rounding, and beyond the transition is
// as before, with the old smoothness in between: knots are inserted at the region's ends and in the
// transition, and every control point that acts in the region goes to the plane. Closed shapes stay
// closed: a region that reaches the seam of one has its transition beyond it, and an edge that is a
// point moves as a whole. Throws std::invalid_argument where a range is empty or leaves the domain,
// the normal is zero, the direction lies in the plane, or the transition is not positive. [Piegl &
// Tiller 1997, §11.4.2]
template <int Dim>
NurbsCurve<Dim> Flattened(const NurbsCurve<Dim>& curve,
                          const ParameterRange& range,
                          const FlattenOptions<Dim>& options);
NurbsSurface Flattened(const NurbsSurface& surface,
                       const ParameterRegion& region,
                       const FlattenOptions<3>& options);

}  // namespace batten
