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

namespace batten::internal {

// Adds to `contents` every face of the roots of a file, then every edge outside faces, with their
// names, and the solids and shells that faces are of. Throws ReadError naming `path` and the face
// or edge that can't be turned into NURBS or holds coordinates above 1e150.
class ShapeCollector {
 public:
  using NameOf = std::function<std::string(const TopoDS_Shape& shape)>;
  ShapeCollector(GeometryContents& contents, NameOf names, const std::string& path)
      : contents_(contents), names_(std::move(names)), path_(path) {}

  void Add(const TopoDS_Shape& root);

 private:
  void AddFaces(const TopoDS_Shape& shape, std::vector<BodyFace>* body);
  void AddBody(const TopoDS_Shape& shape);
  FaceWires AddFace(const TopoDS_Face& face);
  void AddEdge(const TopoDS_Edge& edge);
  template <typename Convert>
  void Keep(const std::string& name, const TopoDS_Shape& shape, Convert convert);

  GeometryContents& contents_;
  NameOf names_;
  const std::string& path_;
  int faces_ = 0, edges_ = 0;
};

// What is lost in separate surfaces and curves, in a sentence: solids, and parts that an assembly
// places; empty: nothing.
std::string WhatIsFlattened(const GeometryContents& contents, int placed_parts);

}  // namespace batten::internal
