// SPDX-License-Identifier: MIT
#include "io/opencascade/iges_export.h"

#include <IGESBasic_Name.hxx>
#include <IGESControl_Controller.hxx>
#include <IGESData_BasicEditor.hxx>
#include <IGESData_GlobalSection.hxx>
#include <IGESData_IGESModel.hxx>
#include <IGESData_IGESWriter.hxx>
#include <IGESData_Protocol.hxx>
#include <IGESGeom_BSplineCurve.hxx>
#include <IGESGeom_BSplineSurface.hxx>
#include <IGESGeom_CurveOnSurface.hxx>
#include <IGESGeom_HArray1OfCurveOnSurface.hxx>
#include <IGESGeom_TrimmedSurface.hxx>
#include <IGESSelect_WorkLibrary.hxx>
#include <Standard_Failure.hxx>
#include <TColStd_HArray1OfReal.hxx>
#include <TColStd_HArray2OfReal.hxx>
#include <TColgp_HArray1OfXYZ.hxx>
#include <TColgp_HArray2OfXYZ.hxx>
#include <TCollection_HAsciiString.hxx>
#include <algorithm>
#include <limits>
#include <locale>
#include <optional>
#include <sstream>
#include <utility>
#include <variant>
#include <vector>

#include "batten/geometry/closure.h"
#include "batten/geometry/direction.h"
#include "batten/geometry/join.h"
#include "batten/geometry/trim_loops.h"
#include "batten/io/read_error.h"
#include "geometry/nurbs/placed_curve.h"
#include "io/base/time_stamp.h"
#include "io/exchange/closed_form.h"
#include "io/exchange/geometry_names.h"
#include "io/exchange/trim_pieces.h"
#include "io/opencascade/occt_convert.h"
#include "io/opencascade/occt_session.h"
#include "io/opencascade/space_curve.h"

namespace batten::internal {
namespace {

Handle(TColStd_HArray1OfReal) Knots(const SplineBasis& basis) {
  Handle(TColStd_HArray1OfReal) knots = new TColStd_HArray1OfReal(-basis.degree(), basis.size());
  for (int i = -basis.degree(); i <= basis.size(); ++i) {
    knots->SetValue(i, basis.knots()[static_cast<size_t>(i + basis.degree())]);
  }
  return knots;
}

Handle(IGESGeom_BSplineCurve) ToIges(const NurbsCurve<3>& curve, bool plane) {
  const SplineBasis& basis = curve.basis();
  const int last = basis.size() - 1;
  Handle(TColStd_HArray1OfReal) weights = new TColStd_HArray1OfReal(0, last);
  Handle(TColgp_HArray1OfXYZ) poles = new TColgp_HArray1OfXYZ(0, last);
  for (int i = 0; i <= last; ++i) {
    const Eigen::Vector3d point = curve.control_points().col(i);
    weights->SetValue(i, curve.weights()[i]);
    poles->SetValue(i, gp_XYZ(point.x(), point.y(), point.z()));
  }
  Handle(IGESGeom_BSplineCurve) entity = new IGESGeom_BSplineCurve;
  entity->Init(last,
               basis.degree(),
               plane,
               Closed(curve),
               !curve.rational(),
               false,
               Knots(basis),
               weights,
               poles,
               basis.lower(),
               basis.upper(),
               gp_XYZ(0, 0, plane ? 1 : 0));
  return entity;
}

Handle(IGESGeom_BSplineSurface) ToIges(const NurbsSurface& surface) {
  const SplineBasis &u = surface.basis_u(), &v = surface.basis_v();
  const int last_u = u.size() - 1, last_v = v.size() - 1;
  Handle(TColStd_HArray2OfReal) weights = new TColStd_HArray2OfReal(0, last_u, 0, last_v);
  Handle(TColgp_HArray2OfXYZ) poles = new TColgp_HArray2OfXYZ(0, last_u, 0, last_v);
  for (int i = 0; i <= last_u; ++i) {
    for (int j = 0; j <= last_v; ++j) {
      const Eigen::Vector3d point = surface.control_point(i, j);
      weights->SetValue(i, j, surface.weights()[Eigen::Index{i} * v.size() + j]);
      poles->SetValue(i, j, gp_XYZ(point.x(), point.y(), point.z()));
    }
  }
  Handle(IGESGeom_BSplineSurface) entity = new IGESGeom_BSplineSurface;
  entity->Init(last_u,
               last_v,
               u.degree(),
               v.degree(),
               Closed(surface, Direction::kU),
               Closed(surface, Direction::kV),
               !surface.rational(),
               false,
               false,
               Knots(u),
               Knots(v),
               weights,
               poles,
               u.lower(),
               u.upper(),
               v.lower(),
               v.upper());
  return entity;
}

bool Collapsed(const CollapsedEdgeSet& edges, Side side) {
  return (side == Side::kULower && edges.u_lower) || (side == Side::kUUpper && edges.u_upper) ||
         (side == Side::kVLower && edges.v_lower) || (side == Side::kVUpper && edges.v_upper);
}

// Builds the entities and adds them to a model.
class ModelBuilder {
 public:
  ModelBuilder(IGESData_BasicEditor& editor) : model_(editor.Model()) {}

  void Add(const NurbsCurve<2>& curve, const std::string& name) {
    AddNamed(ToIges(InSpace(curve), true), name);
  }
  void Add(const NurbsCurve<3>& curve, const std::string& name) {
    AddNamed(ToIges(curve, false), name);
  }
  void Add(const NurbsSurface& surface, const std::string& name) {
    const Handle(IGESGeom_BSplineSurface) base = ToIges(surface);
    if (!surface.trimmed()) return AddNamed(base, name);
    base->InitStatus(0, 1, 0, 0);
    for (const auto& region : LoopsByRegion(surface)) AddRegion(surface, region, base, name);
  }

  static Handle(IGESData_Protocol) Protocol() { return IGESSelect_WorkLibrary::DefineProtocol(); }

 private:
  void AddRegion(const NurbsSurface& surface,
                 const std::vector<NurbsCurve<2>>& loops,
                 const Handle(IGESGeom_BSplineSurface) & base,
                 const std::string& name) {
    Handle(IGESGeom_HArray1OfCurveOnSurface) holes;
    if (loops.size() > 1) {
      holes = new IGESGeom_HArray1OfCurveOnSurface(1, static_cast<int>(loops.size()) - 1);
    }
    for (size_t i = 1; i < loops.size(); ++i) {
      holes->SetValue(static_cast<int>(i), Boundary(surface, loops[i], base));
    }
    Handle(IGESGeom_TrimmedSurface) trimmed = new IGESGeom_TrimmedSurface;
    trimmed->Init(base, 1, Boundary(surface, loops[0], base), holes);
    AddNamed(trimmed, name);
  }

  void AddNamed(const Handle(IGESData_IGESEntity) & entity, const std::string& name) {
    if (!name.empty()) {
      constexpr size_t kLabel = 8;
      constexpr int kDefinition = 2;
      entity->SetLabel(Text(AsciiPart(name, kLabel)));
      Handle(IGESBasic_Name) property = new IGESBasic_Name;
      property->Init(1, Text(name));
      property->InitStatus(0, 1, kDefinition, 0);
      entity->AddProperty(property);
    }
    model_->AddWithRefs(entity, Protocol());
  }

  // The loop as it is, and in space.
  static Handle(IGESGeom_CurveOnSurface) Boundary(const NurbsSurface& surface,
                                                  const NurbsCurve<2>& loop,
                                                  const Handle(IGESGeom_BSplineSurface) & base) {
    constexpr int kUnspecified = 0, kInParameters = 1;
    constexpr int kDependent = 1, kForParameters = 5;
    const Handle(IGESGeom_BSplineCurve) in_parameters = ToIges(InSpace(loop), true);
    in_parameters->InitStatus(0, kDependent, kForParameters, 0);
    Handle(IGESGeom_BSplineCurve) in_space;
    if (const auto curve = LoopInSpace(surface, loop)) {
      in_space = ToIges(*curve, false);
      in_space->InitStatus(0, kDependent, 0, 0);
    }
    Handle(IGESGeom_CurveOnSurface) boundary = new IGESGeom_CurveOnSurface;
    boundary->Init(kUnspecified, base, in_parameters, in_space, kInParameters);
    boundary->InitStatus(0, kDependent, 0, 0);
    return boundary;
  }

  // Piece by piece from corner to corner; pieces on an edge that is a point have no length.
  static std::optional<NurbsCurve<3>> LoopInSpace(const NurbsSurface& surface,
                                                  const NurbsCurve<2>& loop) {
    const Handle(Geom_BSplineSurface) bspline = ToOcct(surface);
    const CollapsedEdgeSet collapsed = CollapsedEdges(surface);
    std::optional<NurbsCurve<3>> chain;
    for (const TrimPiece& piece : TrimPieces(surface, loop)) {
      if (Collapsed(collapsed, piece.side)) continue;
      const NurbsCurve<3> next = FromOcct(*CurveInSpace(bspline, ToOcct2d(piece.curve)));
      chain = chain ? Join(*chain, next, std::numeric_limits<double>::infinity()) : next;
    }
    return chain;
  }

  Handle(IGESData_IGESModel) model_;
};

void SetHeader(const Handle(IGESData_IGESModel) & model,
               const std::vector<Geometry>& geometry,
               const LengthUnit& unit) {
  constexpr int kVersion53 = 11, kIntegerBits = 32, kPower = 308, kDigits = 17;
  const std::string time = TimeStamp("%Y%m%d.%H%M%S");
  double largest = 0;
  for (const Geometry& one : geometry) {
    largest = std::max(
        largest,
        std::visit([](const auto& shape) { return shape.control_points().cwiseAbs().maxCoeff(); },
                   one));
  }
  IGESData_GlobalSection header = model->GlobalSection();
  header.SetSeparator(',');
  header.SetEndMark(';');
  header.SetSendName(Text("batten"));
  header.SetReceiveName(Text("batten"));
  header.SetFileName(Text("batten.igs"));
  header.SetSystemId(Text("batten"));
  header.SetInterfaceVersion(Text("batten"));
  header.SetIntegerBits(kIntegerBits);
  header.SetMaxPower10Single(38);
  header.SetMaxDigitsSingle(6);
  header.SetMaxPower10Double(kPower);
  header.SetMaxDigitsDouble(kDigits);
  header.SetScale(1);
  header.SetUnitFlag(unit.iges_flag);
  header.SetUnitName(Text(unit.iges));
  header.SetLineWeightGrad(1);
  header.SetMaxLineWeight(0.01);
  header.SetDate(Text(time));
  header.SetResolution(1e-7);
  header.SetMaxCoord(largest);
  header.SetAuthorName(Text("batten"));
  header.SetCompanyName(Text(""));
  header.SetIGESVersion(kVersion53);
  header.SetDraftingStandard(0);
  header.SetLastChangeDate(Text(time));
  model->SetGlobalSection(header);
}

std::string ToIgesText(const GeometryFile& file, const LengthUnit& unit) {
  IGESControl_Controller::Init();
  const Handle(IGESData_Protocol) protocol = ModelBuilder::Protocol();
  IGESData_BasicEditor editor(protocol);
  ModelBuilder builder(editor);
  for (size_t i = 0; i < file.geometry.size(); ++i) {
    const std::string name = i < file.names.size() ? CleanName(file.names[i]) : "";
    std::visit([&](const auto& shape) { builder.Add(shape, name); }, ClosedForm(file.geometry[i]));
  }
  SetHeader(editor.Model(), file.geometry, unit);
  IGESData_IGESWriter writer(editor.Model());
  writer.FloatWriter().SetFormat("%.17E");
  writer.FloatWriter().SetZeroSuppress(false);
  writer.SendModel(protocol);
  std::ostringstream stream;
  stream.imbue(std::locale::classic());
  if (!writer.Print(stream)) throw Standard_Failure("OpenCASCADE does not write the model");
  return std::move(stream).str();
}

}  // namespace

std::string ExportIges(const GeometryFile& file, const LengthUnit& unit) {
  try {
    const OcctSession session;
    return ToIgesText(file, unit);
  } catch (const Standard_Failure& failure) {
    throw WriteError(file.path, std::string("can't become IGES: ") + failure.GetMessageString());
  }
}

}  // namespace batten::internal
