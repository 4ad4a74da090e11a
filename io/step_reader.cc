// SPDX-License-Identifier: MIT
#include "batten/io/step_reader.h"

#include <BRep_Tool.hxx>
#include <GeomConvert.hxx>
#include <Geom_RectangularTrimmedSurface.hxx>
#include <Geom_TrimmedCurve.hxx>
#include <STEPControl_Controller.hxx>
#include <STEPControl_Reader.hxx>
#include <Standard_Failure.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <algorithm>
#include <cmath>
#include <istream>
#include <stdexcept>
#include <streambuf>

#include "batten/io/occt_convert.h"
#include "batten/io/occt_exact.h"
#include "batten/io/occt_session.h"
#include "batten/io/parameter_rectangle.h"
#include "batten/io/read_error.h"
#include "batten/io/step_model.h"
#include "batten/io/step_syntax.h"
#include "batten/io/step_units.h"
#include "batten/io/whole_file.h"

namespace batten {
namespace {

constexpr double kLargestCoordinate = 1e150;

// Text in memory as a stream, without a copy.
class TextBuffer : public std::streambuf {
 public:
  explicit TextBuffer(std::string& text) {
    setg(text.data(), text.data(), text.data() + text.size());
  }
};

// The NURBS form on the whole domain, of analytic shapes as batten makes them; what was periodic
// comes back clamped.
NurbsCurve<3> ToNurbs(const Handle(Geom_Curve) & curve, double first, double last, bool closed) {
  if (const auto exact = FromAnalytic(curve, first, last, closed)) return ToNurbs(*exact);
  const double slack = 1e-12 * (last - first);
  Handle(Geom_BSplineCurve) bspline = Handle(Geom_BSplineCurve)::DownCast(curve);
  const bool whole = !bspline.IsNull() && !bspline->IsPeriodic() &&
                     std::abs(first - bspline->FirstParameter()) <= slack &&
                     std::abs(last - bspline->LastParameter()) <= slack;
  if (!whole) {
    bspline = GeomConvert::CurveToBSplineCurve(new Geom_TrimmedCurve(curve, first, last));
    if (bspline->IsPeriodic()) bspline->SetNotPeriodic();
    bspline->Segment(bspline->FirstParameter(), bspline->LastParameter());
  }
  return FromOcct(*bspline);
}

NurbsCurve<3> ToNurbs(const TopoDS_Edge& edge) {
  double first = 0, last = 0;
  Handle(Geom_Curve) curve = BRep_Tool::Curve(edge, first, last);
  if (edge.Orientation() == TopAbs_REVERSED) {
    const double swap = curve->ReversedParameter(first);
    first = curve->ReversedParameter(last);
    last = swap;
    curve = curve->Reversed();
  }
  return ToNurbs(curve, first, last, BRep_Tool::IsClosed(edge));
}

NurbsSurface ToNurbs(const TopoDS_Face& face, const ParameterRectangle& box) {
  const Handle(Geom_Surface) surface = BRep_Tool::Surface(face);
  if (const auto exact = FromAnalytic(surface, box, SeamsOf(face))) return ToNurbs(*exact);
  Handle(Geom_BSplineSurface) bspline = Handle(Geom_BSplineSurface)::DownCast(surface);
  const bool whole = !bspline.IsNull() && !bspline->IsUPeriodic() && !bspline->IsVPeriodic() &&
                     box == NaturalRectangle(*surface);
  if (!whole) {
    bspline = GeomConvert::SurfaceToBSplineSurface(
        new Geom_RectangularTrimmedSurface(surface, box.u0, box.u1, box.v0, box.v1));
    if (bspline->IsUPeriodic()) bspline->SetUNotPeriodic();
    if (bspline->IsVPeriodic()) bspline->SetVNotPeriodic();
    double u0 = 0, u1 = 0, v0 = 0, v1 = 0;
    bspline->Bounds(u0, u1, v0, v1);
    bspline->Segment(u0, u1, v0, v1);
  }
  return FromOcct(*bspline);
}

void CheckRange(const Geometry& geometry, const std::string& what, const std::string& path) {
  const double largest = std::visit(
      [](const auto& one) { return one.control_points().cwiseAbs().maxCoeff(); }, geometry);
  if (!(largest <= kLargestCoordinate)) {
    throw ReadError(path, what + " has a coordinate above 1e150 in magnitude");
  }
}

// The geometry of one root of the file is added to `result`.
class Collector {
 public:
  Collector(std::vector<Geometry>& result, const std::string& path)
      : result_(result), path_(path) {}

  void Add(const TopoDS_Shape& root) {
    for (TopExp_Explorer faces(root, TopAbs_FACE); faces.More(); faces.Next()) {
      AddFace(TopoDS::Face(faces.Current()));
    }
    for (TopExp_Explorer edges(root, TopAbs_EDGE, TopAbs_FACE); edges.More(); edges.Next()) {
      AddEdge(TopoDS::Edge(edges.Current()));
    }
  }

 private:
  void AddFace(const TopoDS_Face& face) {
    const std::string name = "face " + std::to_string(++faces_);
    if (BRep_Tool::Surface(face).IsNull()) throw ReadError(path_, name + " has no surface");
    const auto box = RectangleOf(face);
    if (!box) throw ReadError(path_, name + " is trimmed: not in this version");
    Keep(name, [&] { return ToNurbs(face, *box); });
  }

  void AddEdge(const TopoDS_Edge& edge) {
    double first = 0, last = 0;
    if (BRep_Tool::Degenerated(edge)) return;
    const std::string name = "edge " + std::to_string(++edges_);
    if (BRep_Tool::Curve(edge, first, last).IsNull())
      throw ReadError(path_, name + " has no curve");
    Keep(name, [&] { return ToNurbs(edge); });
  }

  template <typename Convert>
  void Keep(const std::string& name, Convert convert) {
    try {
      result_.emplace_back(convert());
    } catch (const std::invalid_argument& error) {
      throw ReadError(path_, name + ": " + error.what());
    } catch (const Standard_Failure& failure) {
      throw ReadError(path_, name + " can't be turned into NURBS: " + failure.GetMessageString());
    }
    CheckRange(result_.back(), name, path_);
  }

  std::vector<Geometry>& result_;
  const std::string& path_;
  int faces_ = 0, edges_ = 0;
};

std::vector<Geometry> Translate(std::string& text, const std::string& path) {
  STEPControl_Controller::Init();
  STEPControl_Reader reader;
  TextBuffer buffer(text);
  std::istream stream(&buffer);
  if (reader.ReadStream("batten", stream) != IFSelect_RetDone) {
    throw ReadError(path, "is damaged: it can't be parsed as STEP");
  }
  CheckStepModel(reader.StepModel(), path);
  KeepNumbersOf(reader);
  reader.TransferRoots();
  std::vector<Geometry> result;
  Collector collector(result, path);
  for (int i = 1; i <= reader.NbShapes(); ++i) collector.Add(reader.Shape(i));
  if (result.empty()) throw ReadError(path, "holds no curves or surfaces that can be read");
  return result;
}

}  // namespace

std::vector<Geometry> ReadStep(const std::string& path) {
  const std::string name = path == "-" ? "standard input" : path;
  std::string text = ReadWholeFile(path);
  CheckStepSyntax(text, name);
  try {
    const OcctSession session;
    return Translate(text, name);
  } catch (const Standard_Failure& failure) {
    throw ReadError(name, std::string("is damaged: ") + failure.GetMessageString());
  }
}

}  // namespace batten
