// SPDX-License-Identifier: MIT
// What a geometry file holds, how it is read, and how it is written.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <memory>
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
  // Whether a file is refused for one face or curve that can't be read; else the rest is read.
  bool strict = false;
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

// The solids, shells, faces and edges of a STEP, IGES or B-rep file as they stand there: exact
// surfaces, shared edges, orientation. Only the writers of STEP and B-rep look inside.
struct CadShapes {
  std::shared_ptr<const void> held = nullptr;  // of io/opencascade/cad_shapes.h; null: none
  double times = 1, over = 1;  // what their coordinates are multiplied with and divided by
  bool whole = true;           // whether every face and curve of the file is among them
};

// Of a body, in the coordinates of its geometry, to about nine digits. Of an open shell only `area`
// is its own: the rest is of what it closes with the origin.
struct BodyMeasures {
  double area = 0, volume = 0;
  bool inside_out = false;  // the faces look inwards: the volume is positive all the same
  Eigen::Vector3d center = Eigen::Vector3d::Zero();   // of mass
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();  // about the center, at density 1
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
  // Faces and curves of the file that are not among the geometry, and why, a sentence each.
  std::vector<std::string> unread = {};
  CadShapes shapes = {};  // what the geometry is of, the unread among it
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
  // Of the latter, those that would have come out as no valid shape; solids and shells that are
  // written as they were read count here where they are none.
  size_t invalid = 0;
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
  // Where the geometry is just what a file held: STEP and B-rep hold these in its place, unless
  // options.sew says how to sew it.
  CadShapes shapes = {};
};

}  // namespace batten
