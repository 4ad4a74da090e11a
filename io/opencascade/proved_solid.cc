// SPDX-License-Identifier: MIT
#include "io/opencascade/proved_solid.h"

#include <BRepBndLib.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRepGProp.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <GProp_GProps.hxx>
#include <Precision.hxx>
#include <STEPControl_Reader.hxx>
#include <STEPControl_Writer.hxx>
#include <ShapeFix_ShapeTolerance.hxx>
#include <Standard_Failure.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedDataMapOfShapeListOfShape.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <cmath>
#include <sstream>
#include <utility>

#include "io/opencascade/occt_convert.h"
#include "io/opencascade/step_output.h"
#include "io/opencascade/valid_shape.h"

namespace batten::internal {
namespace {

[[noreturn]] void Fail(const std::string& reason) { throw Standard_Failure(reason.c_str()); }

// OpenCASCADE's reader orients a solid by lines through its faces, and tries for ever where it
// takes all places for one.
void CheckSize(const TopoDS_Shape& body) {
  constexpr double kLeast = 3000;  // of its confusion; 2000 hang, 4000 do not
  Bnd_Box box;
  BRepBndLib::Add(body, box);
  const double size = std::sqrt(box.SquareExtent());
  if (!(size > kLeast * Precision::Confusion())) FailAsTooSmall(size);
}

// Of solids, or of shells, which have a volume of zero.
SolidCensus CensusOf(const Bodies& bodies, const std::string& what) {
  SolidCensus census;
  for (const TopoDS_Shape& body : bodies) {
    const bool solid = body.ShapeType() == TopAbs_SOLID;
    if (!BRepCheck_Analyzer(body).IsValid()) Fail(what + " is not valid to OpenCASCADE");
    TopTools_IndexedDataMapOfShapeListOfShape uses;
    TopExp::MapShapesAndAncestors(body, TopAbs_EDGE, TopAbs_FACE, uses);
    int edges = 0;
    for (int k = 1; k <= uses.Extent(); ++k) {
      if (BRep_Tool::Degenerated(TopoDS::Edge(uses.FindKey(k)))) continue;
      if (uses(k).Extent() > 2 || (solid && uses(k).Extent() != 2))
        Fail("an edge of " + what + " does not belong to two faces");
      ++edges;
    }
    TopTools_IndexedMapOfShape faces;
    TopExp::MapShapes(body, TopAbs_FACE, faces);
    census.solids += 1;
    census.faces += faces.Extent();
    census.edges += edges;
    if (solid) {
      GProp_GProps properties;
      BRepGProp::VolumeProperties(body, properties);
      if (!(properties.Mass() > 0)) Fail(what + " is inside out");
      census.volume += properties.Mass();
    }
    GProp_GProps skin;
    BRepGProp::SurfaceProperties(body, skin);
    census.area += skin.Mass();
  }
  return census;
}

SolidCensus Reread(const std::string& text, TopAbs_ShapeEnum kind) {
  std::istringstream stream(text);
  STEPControl_Reader reader;
  if (reader.ReadStream("batten", stream) != IFSelect_RetDone)
    Fail("what is written can't be read");
  reader.TransferRoots();
  Bodies bodies;
  for (int k = 1; k <= reader.NbShapes(); ++k) {
    for (TopExp_Explorer one(reader.Shape(k), kind); one.More(); one.Next())
      bodies.push_back(one.Current());
  }
  return CensusOf(bodies, "what is read back");
}

bool Same(double one, double other) {
  constexpr double kSame = 1e-6;
  return std::abs(one - other) <= kSame * other;
}

}  // namespace

ProvedSolid ProvedStep(const Bodies& bodies, double size, const char* unit, const char* schema) {
  const bool solids = bodies.at(0).ShapeType() == TopAbs_SOLID;
  if (solids)
    for (const TopoDS_Shape& one : bodies) CheckSize(one);
  // Far from zero rounding exceeds OpenCASCADE's own 1e-7.
  for (const TopoDS_Shape& one : bodies) {
    for (double tolerance = Precision::Confusion(); !BRepCheck_Analyzer(one).IsValid();) {
      tolerance *= 10;
      if (!(tolerance <= 1e-6 * size)) break;
      ShapeFix_ShapeTolerance().SetTolerance(one, tolerance);
    }
  }
  const SolidCensus made = CensusOf(bodies, solids ? "the solid" : "the shell");
  BeginStep(unit, schema);
  STEPControl_Writer writer;
  const auto form = solids ? STEPControl_ManifoldSolidBrep : STEPControl_ShellBasedSurfaceModel;
  for (const TopoDS_Shape& one : bodies) {
    if (writer.Transfer(one, form) != IFSelect_RetDone)
      Fail(std::string("OpenCASCADE does not translate ") + (solids ? "the solid" : "the shell"));
  }
  NameProducts(writer, {});
  std::string text = StepTextOf(writer);
  const SolidCensus read = Reread(text, solids ? TopAbs_SOLID : TopAbs_SHELL);
  if (read.solids != made.solids || read.faces != made.faces || read.edges != made.edges ||
      !Same(read.volume, made.volume) || !Same(read.area, made.area)) {
    Fail("what is read back is not what was written");
  }
  return {std::move(text), made};
}

}  // namespace batten::internal
