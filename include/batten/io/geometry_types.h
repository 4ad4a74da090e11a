// SPDX-License-Identifier: MIT
// What a geometry file holds, how it is read, and how it is written.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"
#include "batten/geometry/triangle_mesh.h"

namespace batten {

// What a geometry file holds.
using Geometry = std::variant<NurbsCurve<2>, NurbsCurve<3>, NurbsSurface>;

struct GeometryReadOptions {
  std::string format = {};  // "json", "step", "iges" or "brep"; empty: by the path's extension
  std::string unit = {};    // what coordinates are turned into, of length_unit.h; empty: the file's
  // What a file that says none is in; empty: the unit asked for, its coordinates stay.
  std::string undeclared = {};
};

// An edge of one face alone.
struct FreeEdge {
  size_t surface;  // the face's, in the file's geometry
  Eigen::Vector3d from, to;
};

// Faces that share edges in a file: a solid, or a shell outside solids.
struct GeometryBody {
  std::string name = {};              // empty where the file gives none
  bool solid = false;                 // or a shell
  std::vector<size_t> surfaces = {};  // its faces, in the file's geometry
  size_t shared_edges = 0;            // between faces, seams aside
  std::vector<FreeEdge> free_edges = {};
  // Of its surfaces, in their order, for TessellateShell: which edges the faces share, and where
  // those lie in their parameters. A face whose edges can't be followed there has no loops.
  std::vector<FaceBorder> borders = {};
  // Within which edges are shared: the largest tolerance the file gives them and their corners, at
  // least 1e-6 of the body's size, in the unit of the coordinates.
  double tolerance = 0;

  bool watertight() const { return free_edges.empty(); }
};

// Everything a geometry file says.
struct GeometryContents {
  std::vector<Geometry> geometry;  // in the file's order; at least one
  std::vector<std::string> names;  // of each, UTF-8 on one line; empty where the file gives none
  std::string unit;                // of the coordinates; empty: the file does not say
  std::vector<std::string> remarks = {};  // what was not quite as it should be, a sentence each
  std::vector<GeometryBody> bodies = {};  // solids, and shells of several faces
  // What is lost where the geometry is taken by itself, without its bodies, a sentence; empty:
  // nothing.
  std::string flattened = {};
};

struct GeometryWriteOptions {
  std::string format = {};  // "json", "step", "iges" or "brep"; empty: by the path's extension
  std::string unit = "mm";  // of the coordinates: declared, never scaled
  std::string step_schema = "ap214";  // or "ap242": the application protocol of STEP
  // STEP and B-rep: within which distance edges of surfaces become one, in the unit of the
  // coordinates; 0: none do. Unset: those of bodies, within the body's own tolerance.
  std::optional<double> sew = {};
};

// What sewing made of surfaces.
struct SewingReport {
  size_t surfaces = 0;                       // that were to be sewn
  size_t solids = 0, shells = 0, loose = 0;  // closed shells, open ones, faces left by themselves
  size_t invalid = 0;  // of the latter, those that would have come out as no valid shape
  size_t shared_edges = 0, free_edges = 0;
  double largest_gap = 0;  // between surfaces along a shared edge
  // The least distance from a free edge to another one; none where there are fewer than two.
  std::optional<double> nearest_gap = {};

  bool watertight() const { return solids > 0 && free_edges == 0; }
};

// What becomes a geometry file.
struct GeometryFile {
  std::string path;
  std::vector<Geometry> geometry;
  std::vector<std::string> names = {};    // of each, where there are any; empty: no name of its own
  std::vector<GeometryBody> bodies = {};  // which surfaces belong together (options.sew)
};

}  // namespace batten
