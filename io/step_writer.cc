// SPDX-License-Identifier: MIT
#include "batten/io/step_writer.h"

#include <APIHeaderSection_MakeHeader.hxx>
#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <Interface_Static.hxx>
#include <Precision.hxx>
#include <STEPConstruct.hxx>
#include <STEPControl_Controller.hxx>
#include <STEPControl_Writer.hxx>
#include <ShapeFix_ShapeTolerance.hxx>
#include <Standard_Failure.hxx>
#include <StepBasic_Product.hxx>
#include <StepData_Protocol.hxx>
#include <StepData_StepModel.hxx>
#include <StepData_StepWriter.hxx>
#include <StepRepr_RepresentationItem.hxx>
#include <TCollection_HAsciiString.hxx>
#include <TopoDS_Shape.hxx>
#include <Transfer_FinderProcess.hxx>
#include <XSControl_TransferWriter.hxx>
#include <XSControl_WorkSession.hxx>
#include <algorithm>
#include <cctype>
#include <charconv>
#include <cstdint>
#include <iterator>
#include <locale>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <variant>

#include "batten/geometry/exact_shape.h"
#include "batten/io/atomic_file.h"
#include "batten/io/closed_form.h"
#include "batten/io/geometry_names.h"
#include "batten/io/length_unit.h"
#include "batten/io/occt_convert.h"
#include "batten/io/occt_exact.h"
#include "batten/io/occt_session.h"
#include "batten/io/read_error.h"
#include "batten/io/time_stamp.h"
#include "batten/io/trimmed_face.h"

namespace batten {
namespace {

// The word OpenCASCADE knows an application protocol by.
const char* OcctSchema(const std::string& schema) {
  if (schema == "ap214") return "AP214IS";
  if (schema == "ap242") return "AP242DIS";
  throw UsageError("STEP schema \"" + schema + "\" is not one of ap214, ap242");
}

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
  if (surface.trimmed()) return ToTrimmedFace(surface);
  if (const auto analytic = AnalyticShape(surface)) return *analytic;
  const Handle(Geom_BSplineSurface) bspline = ToOcct(surface);
  BRepBuilderAPI_MakeFace face(bspline, Precision::Confusion());
  if (!face.IsDone()) throw Standard_Failure("no face can be built on the surface");
  return face.Shape();
}

const NurbsCurve<3>& InSpace(const NurbsCurve<3>& curve) { return curve; }
NurbsCurve<3> InSpace(const NurbsCurve<2>& curve) {
  Eigen::Matrix3Xd points = Eigen::Matrix3Xd::Zero(3, curve.control_points().cols());
  points.topRows<2>() = curve.control_points();
  return NurbsCurve<3>(curve.basis(), std::move(points), curve.weights());
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
  const TopoDS_Shape shape = std::visit([](const auto& one) { return ToShape(one); }, geometry);
  const double size = std::visit([](const auto& one) { return SizeOf(one); }, geometry);
  for (double tolerance = Precision::Confusion(); !BRepCheck_Analyzer(shape).IsValid();) {
    tolerance *= 10;
    if (!(tolerance <= 1e-6 * size)) {
      throw Standard_Failure("its B-rep is not valid (too small, or folded onto its own boundary)");
    }
    ShapeFix_ShapeTolerance().SetTolerance(shape, tolerance);
  }
  return shape;
}

Handle(TCollection_HAsciiString) Text(const std::string& text) {
  return new TCollection_HAsciiString(text.c_str());
}

void SetHeader(const Handle(StepData_StepModel) & model) {
  APIHeaderSection_MakeHeader header(model);
  header.SetName(Text("batten"));
  header.SetTimeStamp(Text(TimeStamp("%Y-%m-%dT%H:%M:%S")));
  header.SetAuthorValue(1, Text("batten"));
  header.SetOrganizationValue(1, Text(""));
  header.SetPreprocessorVersion(Text("batten"));
  header.SetOriginatingSystem(Text("batten"));
  header.SetAuthorisation(Text(""));
  header.SetDescriptionValue(1, Text("NURBS fitted by batten"));
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

// A real number as STEP wants it, with a decimal point, in the shortest form that reads back
// exactly.
std::string ShortestReal(double value) {
  char digits[40];
  std::string text(digits, std::to_chars(digits, digits + sizeof digits, value).ptr);
  const size_t exponent = text.find('e');
  if (exponent != std::string::npos) text[exponent] = 'E';
  if (text.find('.') == std::string::npos) text.insert(std::min(exponent, text.size()), 1, '.');
  return text;
}

// The text with every real number, which OpenCASCADE wrote with 17 digits and an exponent, in its
// shortest form. Strings keep to ASCII and, as OpenCASCADE breaks long ones, to one line.
std::string WithShortestReals(const std::string& text) {
  std::string result;
  result.reserve(text.size());
  bool quoted = false;
  for (size_t i = 0; i < text.size();) {
    const char c = text[i];
    if (quoted && c == '\'') {
      // OpenCASCADE's parser takes a doubled quote for the end unless a letter or digit follows.
      const size_t second = std::min(text.find_first_not_of('\n', i + 1), text.size());
      const size_t after = std::min(text.find_first_not_of('\n', second + 1), text.size());
      if (second < text.size() && text[second] == '\'') {
        const bool plain =
            after < text.size() && std::isalnum(static_cast<unsigned char>(text[after]));
        result += plain ? "\'\'" : "\\X2\\0027\\X0\\";
        i = second + 1;
        continue;
      }
    }
    if (c == '\'') quoted = !quoted;
    if (quoted && c != '\'') {
      const size_t end = std::min(text.find('\'', i), text.size());
      std::string inside = text.substr(i, end - i);
      inside.erase(std::remove(inside.begin(), inside.end(), '\n'), inside.end());
      result += ToStepText(inside);
      i = end;
      continue;
    }
    const bool starts = !quoted && (c == '-' || (c >= '0' && c <= '9'));
    const size_t end =
        starts ? std::min(text.find_first_not_of("0123456789.E+-", i), text.size()) : i + 1;
    const std::string_view token = std::string_view(text).substr(i, end - i);
    double value = 0;
    const bool real = starts && token.find('E') != token.npos &&
                      std::from_chars(token.data(), token.data() + token.size(), value).ptr ==
                          token.data() + token.size();
    result += real ? ShortestReal(value) : std::string(token);
    i = end;
  }
  return result;
}

std::string ToStep(const GeometryFile& file, const char* unit, const char* schema) {
  STEPControl_Controller::Init();
  Interface_Static::SetCVal("write.step.schema", schema);
  Interface_Static::SetCVal("write.step.unit", unit);
  Interface_Static::SetCVal("xstep.cascade.unit", unit);
  Interface_Static::SetCVal("write.step.product.name", "batten");
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
  const Handle(StepData_StepModel) model = writer.Model();
  SetHeader(model);
  NameProducts(model, file);
  StepData_StepWriter text(model);
  text.FloatWriter().SetFormat("%.16E");
  text.FloatWriter().SetZeroSuppress(false);
  text.SendModel(Handle(StepData_Protocol)::DownCast(writer.WS()->Protocol()));
  std::ostringstream stream;
  stream.imbue(std::locale::classic());
  if (!text.Print(stream)) throw Standard_Failure("OpenCASCADE does not write the model");
  return WithShortestReals(std::move(stream).str());
}

}  // namespace

void WriteStep(const std::vector<Geometry>& geometry,
               const std::string& path,
               const std::string& unit) {
  WriteStep(GeometryFile{path, geometry}, {.unit = unit});
}

void WriteStep(const GeometryFile& file, const GeometryWriteOptions& options) {
  if (file.geometry.empty()) throw std::invalid_argument("WriteStep: there is no geometry");
  const char* unit = LengthUnitOf(options.unit).step;
  const char* schema = OcctSchema(options.step_schema);
  AtomicFile target(file.path);
  try {
    const OcctSession session;
    target.Write(ToStep(file, unit, schema));
  } catch (const Standard_Failure& failure) {
    throw WriteError(file.path, std::string("can't become STEP: ") + failure.GetMessageString());
  }
  target.Commit();
}

}  // namespace batten
