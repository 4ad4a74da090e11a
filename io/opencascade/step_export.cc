// SPDX-License-Identifier: MIT
#include "io/opencascade/step_export.h"

#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <Precision.hxx>
#include <STEPConstruct.hxx>
#include <STEPControl_Writer.hxx>
#include <ShapeFix_ShapeTolerance.hxx>
#include <Standard_Failure.hxx>
#include <StepBasic_Product.hxx>
#include <StepData_StepModel.hxx>
#include <StepRepr_RepresentationItem.hxx>
#include <TCollection_HAsciiString.hxx>
#include <TopoDS_Shape.hxx>
#include <Transfer_FinderProcess.hxx>
#include <XSControl_TransferWriter.hxx>
#include <XSControl_WorkSession.hxx>
#include <optional>
#include <utility>
#include <variant>

#include "batten/geometry/exact_shape.h"
#include "batten/io/read_error.h"
#include "geometry/numeric/number_text.h"
#include "io/exchange/closed_form.h"
#include "io/exchange/geometry_names.h"
#include "io/opencascade/occt_convert.h"
#include "io/opencascade/occt_exact.h"
#include "io/opencascade/occt_session.h"
#include "io/opencascade/step_output.h"
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

// The shape with the smallest tolerance, by powers of ten from OpenCASCADE's own 1e-7 to a
// millionth of its size, at which it is valid: with large coordinates or high degrees rounding
// exceeds 1e-7.
TopoDS_Shape ValidShape(const Geometry& geometry) {
  const double size = std::visit([](const auto& one) { return SizeOf(one); }, geometry);
  if (!(size > 10 * Precision::Confusion())) {
    throw Standard_Failure(
        ("it measures " + NumberText(size) +
         ", and readers of STEP take points within 1e-7 for one: use a smaller unit, or JSON")
            .c_str());
  }
  const TopoDS_Shape shape = std::visit([](const auto& one) { return ToShape(one); }, geometry);
  for (double tolerance = Precision::Confusion(); !BRepCheck_Analyzer(shape).IsValid();) {
    tolerance *= 10;
    if (!(tolerance <= 1e-6 * size)) {
      throw Standard_Failure("its B-rep is not valid (too small, or folded onto its own boundary)");
    }
    ShapeFix_ShapeTolerance().SetTolerance(shape, tolerance);
  }
  return shape;
}

std::string NameOf(const GeometryFile& file, size_t index) {
  return index < file.names.size() ? CleanName(file.names[index]) : "";
}

// "batten-1", "batten-2", … where there is no name: OpenCASCADE's own count the products of the
// whole process.
void NameProducts(const Handle(StepData_StepModel) & model, const GeometryFile& file) {
  size_t count = 0;
  for (int i = 1; i <= model->NbEntities(); ++i) {
    const auto product = Handle(StepBasic_Product)::DownCast(model->Value(i));
    if (product.IsNull()) continue;
    std::string name = NameOf(file, count++);
    if (name.empty()) name = "batten-" + std::to_string(count);
    product->SetId(Text(name));
    product->SetName(Text(name));
  }
}

// Gives the name to the entity of a shape, which of an edge is that of its curve.
void NameItem(const STEPControl_Writer& writer,
              const TopoDS_Shape& shape,
              const std::string& name) {
  if (name.empty()) return;
  const auto process = writer.WS()->TransferWriter()->FinderProcess();
  const auto item = STEPConstruct::FindEntity(process, shape);
  if (!item.IsNull()) item->SetName(Text(name));
}

std::string ToStep(const GeometryFile& file, const char* unit, const char* schema) {
  BeginStep(unit, schema);
  STEPControl_Writer writer;
  for (size_t i = 0; i < file.geometry.size(); ++i) {
    const TopoDS_Shape shape = ValidShape(ClosedForm(file.geometry[i]));
    // The graph of the whole model, made anew for each shape, would take quadratic time.
    const bool graph = i + 1 == file.geometry.size();
    if (writer.Transfer(shape, STEPControl_AsIs, graph) != IFSelect_RetDone) {
      throw Standard_Failure("OpenCASCADE does not translate the shape to STEP");
    }
    NameItem(writer, shape, NameOf(file, i));
  }
  NameProducts(writer.Model(), file);
  return StepTextOf(writer);
}

}  // namespace

std::string ExportStep(const GeometryFile& file, const char* unit, const char* schema) {
  try {
    const OcctSession session;
    return ToStep(file, unit, schema);
  } catch (const Standard_Failure& failure) {
    throw WriteError(file.path, std::string("can't become STEP: ") + failure.GetMessageString());
  }
}

}  // namespace batten::internal
