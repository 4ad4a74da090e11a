// SPDX-License-Identifier: MIT
#include "io/opencascade/proved_solid.h"

#include <BRepCheck_Analyzer.hxx>
#include <BRepGProp.hxx>
#include <BRep_Tool.hxx>
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

namespace batten::internal {
namespace {

[[noreturn]] void Fail(const std::string& reason) { throw Standard_Failure(reason.c_str()); }

SolidCensus CensusOf(const std::vector<TopoDS_Solid>& solids, const std::string& what) {
  SolidCensus census;
  for (const TopoDS_Solid& solid : solids) {
    if (!BRepCheck_Analyzer(solid).IsValid()) Fail(what + " is not valid to OpenCASCADE");
    TopTools_IndexedDataMapOfShapeListOfShape uses;
    TopExp::MapShapesAndAncestors(solid, TopAbs_EDGE, TopAbs_FACE, uses);
    int edges = 0;
    for (int k = 1; k <= uses.Extent(); ++k) {
      if (BRep_Tool::Degenerated(TopoDS::Edge(uses.FindKey(k)))) continue;
      if (uses(k).Extent() != 2) Fail("an edge of " + what + " does not belong to two faces");
      ++edges;
    }
    TopTools_IndexedMapOfShape faces;
    TopExp::MapShapes(solid, TopAbs_FACE, faces);
    GProp_GProps properties;
    BRepGProp::VolumeProperties(solid, properties);
    if (!(properties.Mass() > 0)) Fail(what + " is inside out");
    census.solids += 1;
    census.faces += faces.Extent();
    census.edges += edges;
    census.volume += properties.Mass();
    GProp_GProps skin;
    BRepGProp::SurfaceProperties(solid, skin);
    census.area += skin.Mass();
  }
  return census;
}

SolidCensus Reread(const std::string& text) {
  std::istringstream stream(text);
  STEPControl_Reader reader;
  if (reader.ReadStream("batten", stream) != IFSelect_RetDone)
    Fail("what is written can't be read");
  reader.TransferRoots();
  std::vector<TopoDS_Solid> solids;
  for (int k = 1; k <= reader.NbShapes(); ++k) {
    for (TopExp_Explorer one(reader.Shape(k), TopAbs_SOLID); one.More(); one.Next()) {
      solids.push_back(TopoDS::Solid(one.Current()));
    }
  }
  return CensusOf(solids, "the solid read back");
}

}  // namespace

ProvedSolid ProvedStep(const std::vector<TopoDS_Solid>& solids,
                       double size,
                       const char* unit,
                       const char* schema) {
  // Far from zero rounding exceeds OpenCASCADE's own 1e-7.
  for (const TopoDS_Solid& one : solids) {
    for (double tolerance = Precision::Confusion(); !BRepCheck_Analyzer(one).IsValid();) {
      tolerance *= 10;
      if (!(tolerance <= 1e-6 * size)) break;
      ShapeFix_ShapeTolerance().SetTolerance(one, tolerance);
    }
  }
  const SolidCensus made = CensusOf(solids, "the solid");
  BeginStep(unit, schema);
  STEPControl_Writer writer;
  for (const TopoDS_Solid& one : solids) {
    if (writer.Transfer(one, STEPControl_ManifoldSolidBrep) != IFSelect_RetDone) {
      Fail("OpenCASCADE does not translate the solid");
    }
  }
  NameProducts(writer, {});
  std::string text = StepTextOf(writer);
  const SolidCensus read = Reread(text);
  constexpr double kSameVolume = 1e-6;
  if (read.solids != made.solids || read.faces != made.faces || read.edges != made.edges ||
      !(std::abs(read.volume - made.volume) <= kSameVolume * made.volume)) {
    Fail("what is read back is not what was written");
  }
  return {std::move(text), made};
}

}  // namespace batten::internal
