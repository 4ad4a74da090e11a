// SPDX-License-Identifier: MIT
// What a file's shapes hold, as NURBS. Not installed; includes OpenCASCADE.
#pragma once

#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Shape.hxx>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "batten/io/geometry_types.h"
#include "io/opencascade/body_edges.h"
#include "io/opencascade/cad_shapes.h"

namespace batten::internal {

// Adds to `contents` every face of the roots of a file, then every edge outside faces, with their
// names, and the solids and shells that faces are of; a face or edge that can't be turned into
// NURBS or holds coordinates above 1e150 is among the unread.
class ShapeCollector {
 public:
  using NameOf = std::function<std::string(const TopoDS_Shape& shape)>;
  ShapeCollector(GeometryContents& contents, NameOf names)
      : contents_(contents), names_(std::move(names)) {}

  void Add(const TopoDS_Shape& root);

  // Parts of the file that are not among the roots: they are unread, and written by nobody.
  void TellLost(const std::vector<std::string>& lost);

  // After the last of the roots: hands the shapes over, unless writers would fail at them.
  void Finish();

 private:
  void AddFaces(const TopoDS_Shape& shape, std::vector<BodyFace>* body);
  void AddBody(const TopoDS_Shape& shape);
  void AddFace(const TopoDS_Face& face, std::vector<BodyFace>* body);
  void AddEdge(const TopoDS_Edge& edge);
  template <typename Convert>
  bool Keep(const std::string& name, const TopoDS_Shape& shape, Convert convert);
  void KeepShape(const TopoDS_Shape& shape);
  std::string NameIn(const TopoDS_Shape& shape) const { return names_ ? names_(shape) : ""; }

  GeometryContents& contents_;
  NameOf names_;
  HeldShapes held_;
  bool writable_ = true;  // whether writers can do with all of the shapes
  int faces_ = 0, edges_ = 0;
};

// Throws ReadError naming `path` where nothing was read, with why the first was not, or else
// `empty`.
void RequireGeometry(const GeometryContents& contents,
                     const std::string& path,
                     const std::string& empty);

// What is lost in separate surfaces and curves, in a sentence: solids, and parts that an assembly
// places; empty: nothing.
std::string WhatIsFlattened(const GeometryContents& contents, int placed_parts);

}  // namespace batten::internal
