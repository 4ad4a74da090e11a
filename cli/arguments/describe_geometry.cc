// SPDX-License-Identifier: MIT
#include "cli/arguments/describe_geometry.h"

#include <optional>

#include "batten/geometry/arc_length.h"
#include "batten/geometry/bounding_box.h"
#include "batten/geometry/closure.h"
#include "batten/geometry/curvature_range.h"
#include "batten/geometry/surface_area.h"

namespace batten::internal {
namespace {

void SetCurvature(const std::optional<CurvatureInterval>& range, ShapeMeasures& measures) {
  if (!range) return;
  measures.curvature_min = range->min;
  measures.curvature_max = range->max;
}

}  // namespace

template <int Dim>
std::vector<bool> ClosedDirections(const NurbsCurve<Dim>& curve) {
  return {Closed(curve)};
}

std::vector<bool> ClosedDirections(const NurbsSurface& surface) {
  return {Closed(surface, Direction::kU), Closed(surface, Direction::kV)};
}

template <int Dim>
ShapeMeasures Measure(const NurbsCurve<Dim>& curve) {
  const Eigen::AlignedBox<double, Dim> box = BoundingBox(curve);
  ShapeMeasures measures;
  measures.box = Eigen::AlignedBox3d(Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero());
  measures.box.min().template head<Dim>() = box.min();
  measures.box.max().template head<Dim>() = box.max();
  measures.size = ArcLength(curve);
  SetCurvature(CurvatureRange(curve), measures);
  return measures;
}

ShapeMeasures Measure(const NurbsSurface& surface) {
  ShapeMeasures measures;
  measures.box = BoundingBox(surface);
  measures.size = Area(surface);
  SetCurvature(CurvatureRange(surface), measures);
  return measures;
}

template std::vector<bool> ClosedDirections(const NurbsCurve<2>&);
template std::vector<bool> ClosedDirections(const NurbsCurve<3>&);
template ShapeMeasures Measure(const NurbsCurve<2>&);
template ShapeMeasures Measure(const NurbsCurve<3>&);

}  // namespace batten::internal
