// SPDX-License-Identifier: MIT
#include "io/opencascade/valid_shape.h"

#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <Precision.hxx>
#include <ShapeFix_ShapeTolerance.hxx>
#include <Standard_Failure.hxx>
#include <optional>
#include <variant>

#include "batten/geometry/exact_shape.h"
#include "geometry/numeric/number_text.h"
#include "geometry/nurbs/placed_curve.h"
#include "io/exchange/closed_form.h"
#include "io/opencascade/occt_convert.h"
#include "io/opencascade/occt_exact.h"
#include "io/opencascade/trimmed_face.h"

namespace batten::internal {
namespace {

// The diagonal of the control points' bounding box.
template <typename Shape>
double SizeOf(const Shape& shape) {
  const auto& points = shape.control_points();
  return (points.rowwise().maxCoeff() - points.rowwise().minCoeff()).norm();
}

// The analytic form of exact shapes that do not drown in OpenCASCADE's tolerance.
template <typename Shape>
std::optional<TopoDS_Shape> AnalyticShape(const Shape& shape) {
  if (!(SizeOf(shape) > 10 * Precision::Confusion())) return std::nullopt;
  const auto exact = ExactShapeOf(shape);
  return exact ? ToAnalyticShape(*exact) : std::nullopt;
}

// A natural boundary, degenerate and seam edges included.
TopoDS_Shape ToShape(const NurbsSurface& surface) {
  if (surface.trimmed()) return ToTrimmedFaces(surface);
  if (const auto analytic = AnalyticShape(surface)) return *analytic;
  const Handle(Geom_BSplineSurface) bspline = ToOcct(surface);
  BRepBuilderAPI_MakeFace face(bspline, Precision::Confusion());
  if (!face.IsDone()) throw Standard_Failure("no face can be built on the surface");
  return face.Shape();
}

template <int Dim>
TopoDS_Shape ToShape(const NurbsCurve<Dim>& curve) {
  if (const auto analytic = AnalyticShape(InSpace(curve))) return *analytic;
  const Handle(Geom_BSplineCurve) bspline = ToOcct(curve);
  BRepBuilderAPI_MakeEdge edge(bspline);
  if (!edge.IsDone()) throw Standard_Failure("no edge can be built on the curve");
  return edge.Shape();
}

}  // namespace

void FailAsTooSmall(double size) {
  throw Standard_Failure(
      ("it measures " + NumberText(size) +
       ", and readers of STEP take points within 1e-7 for one: use a smaller unit, or JSON")
          .c_str());
}

TopoDS_Shape ValidShape(const Geometry& given) {
  const Geometry geometry = ClosedForm(given);
  const double size = std::visit([](const auto& one) { return SizeOf(one); }, geometry);
  if (!(size > 10 * Precision::Confusion())) FailAsTooSmall(size);
  const TopoDS_Shape shape = std::visit([](const auto& one) { return ToShape(one); }, geometry);
  for (double tolerance = Precision::Confusion(); !BRepCheck_Analyzer(shape).IsValid();) {
    tolerance *= 10;
    if (!(tolerance <= 1e-6 * size)) {
      throw Standard_Failure(
          "its B-rep is not valid (too small, too far from zero for its size, or folded onto its "
          "own boundary)");
    }
    ShapeFix_ShapeTolerance().SetTolerance(shape, tolerance);
  }
  return shape;
}

}  // namespace batten::internal
