// SPDX-License-Identifier: MIT
#include "io/opencascade/brep_import.h"

#include <BRepTools.hxx>
#include <BRep_Builder.hxx>
#include <Standard_Failure.hxx>
#include <TopoDS_Shape.hxx>
#include <istream>

#include "batten/io/read_error.h"
#include "io/exchange/only_lines.h"
#include "io/opencascade/occt_session.h"
#include "io/opencascade/occt_shapes.h"
#include "io/opencascade/text_buffer.h"

namespace batten::internal {
namespace {

GeometryContents TranslateBrep(std::string& text, const std::string& path) {
  TextBuffer buffer(text);
  std::istream stream(&buffer);
  TopoDS_Shape shape;
  BRepTools::Read(shape, stream, BRep_Builder());
  if (shape.IsNull()) throw ReadError(path, "is damaged: OpenCASCADE makes no shape of it");
  GeometryContents contents;
  ShapeCollector collector(contents, {});
  collector.Add(shape);
  collector.Finish();
  RequireGeometry(contents, path, "holds no curves or surfaces");
  if (OnlyLines(contents.geometry)) {
    contents.remarks.push_back("it holds only lines: they are curves of degree 1");
  }
  contents.flattened = WhatIsFlattened(contents, 0);
  return contents;
}

}  // namespace

GeometryContents ImportBrep(std::string text, const std::string& name) {
  try {
    const OcctSession session;
    return TranslateBrep(text, name);
  } catch (const Standard_Failure& failure) {
    throw ReadError(name, std::string("is damaged: ") + failure.GetMessageString());
  }
}

}  // namespace batten::internal
