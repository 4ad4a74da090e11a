// SPDX-License-Identifier: MIT
// The edges of faces: which are shared, which are free. Not installed; includes OpenCASCADE.
#pragma once

#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <vector>

#include "batten/io/geometry_types.h"
#include "io/opencascade/occt_face.h"

namespace batten::internal {

struct EdgeOfFaces {
  TopoDS_Edge edge;
  std::vector<size_t> faces;  // by their places in the list, each once; of a seam one
  bool seam = false;          // on both sides of one face

  bool free() const { return faces.size() == 1 && !seam; }
};

// Every edge that is not a point, once.
std::vector<EdgeOfFaces> FaceEdges(const std::vector<TopoDS_Face>& faces);

// A face of a body, and the surface it has become: its place in the file's geometry.
struct BodyFace {
  TopoDS_Face face;
  size_t surface;
  FaceWires wires;
};

GeometryBody BodyOf(const std::vector<BodyFace>& faces);

}  // namespace batten::internal
