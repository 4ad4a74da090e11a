// SPDX-License-Identifier: MIT
// What `info` and `compare` say of a curve or surface beyond its numbers.
#pragma once

#include <Eigen/Geometry>
#include <limits>
#include <vector>

#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"

namespace batten::internal {

// Per direction: the two ends meet, to 1e-9 of the control points' extent.
template <int Dim>
std::vector<bool> ClosedDirections(const NurbsCurve<Dim>& curve);
std::vector<bool> ClosedDirections(const NurbsSurface& surface);

struct ShapeMeasures {
  Eigen::AlignedBox3d box;  // plane curves: z = 0
  double size = 0;          // length or area
  // Extremes of a curve's curvature, of a surface's principal curvatures, infinite where they grow
  // without bound; min > max where there is no curvature.
  double curvature_min = std::numeric_limits<double>::infinity();
  double curvature_max = -std::numeric_limits<double>::infinity();
};
template <int Dim>
ShapeMeasures Measure(const NurbsCurve<Dim>& curve);
ShapeMeasures Measure(const NurbsSurface& surface);

extern template std::vector<bool> ClosedDirections(const NurbsCurve<2>&);
extern template std::vector<bool> ClosedDirections(const NurbsCurve<3>&);
extern template ShapeMeasures Measure(const NurbsCurve<2>&);
extern template ShapeMeasures Measure(const NurbsCurve<3>&);

}  // namespace batten::internal
