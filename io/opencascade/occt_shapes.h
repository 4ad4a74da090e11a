// SPDX-License-Identifier: MIT
// What a file's shapes hold, as NURBS. Not installed; includes OpenCASCADE.
#pragma once

#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Shape.hxx>
#include <string>
#include <vector>

#include "batten/io/geometry_types.h"
#include "io/opencascade/step_names.h"

namespace batten::internal {

// Adds to `contents` every face of the roots of a file, then every edge outside faces, with their
// names. Throws
// ReadError naming `path` and the face or edge that can't be turned into NURBS or holds coordinates
// above 1e150.
class ShapeCollector {
 public:
  ShapeCollector(GeometryContents& contents, const StepNames& names, const std::string& path)
      : contents_(contents), names_(names), path_(path) {}

  void Add(const TopoDS_Shape& root);

 private:
  void AddFace(const TopoDS_Face& face);
  void AddEdge(const TopoDS_Edge& edge);
  template <typename Convert>
  void Keep(const std::string& name, const TopoDS_Shape& shape, Convert convert);

  GeometryContents& contents_;
  const StepNames& names_;
  const std::string& path_;
  int faces_ = 0, edges_ = 0;
};

}  // namespace batten::internal
