// SPDX-License-Identifier: MIT
// A solid of spline faces that share their edges and vertices.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"
#include "batten/geometry/triangle_mesh.h"

namespace batten {

// An edge as a face sees it: the face's parameters at the ends of the edge's curve, between which
// they run evenly with the curve's own.
struct SolidCoedge {
  int edge = 0;
  bool reversed = false;  // the loop runs against the curve
  Eigen::Vector2d from = Eigen::Vector2d::Zero(), to = Eigen::Vector2d::Zero();
};

struct SolidEdge {
  NurbsCurve<3> curve;
  int start = 0, end = 0;  // vertices
  bool sharp = false;      // its faces need not have the same tangent planes
};

// The whole of an untrimmed surface whose normal points outwards, bounded by one loop,
// counter-clockwise in its parameters from the corner (low, low) on; a side may be several edges.
struct SolidFace {
  NurbsSurface surface;
  std::vector<SolidCoedge> loop;
};

// Faces of closed shells: every edge belongs to two of them, which run along it in opposite
// directions. Of open ones, which are no solids, borders belong to one.
struct SolidModel {
  Eigen::Matrix3Xd vertices;
  std::vector<SolidEdge> edges;
  std::vector<SolidFace> faces;
  bool open = false;  // a shell with borders is meant

  // The shell that is left without some faces, marked by face, and without the edges and vertices
  // that only they have.
  SolidModel Without(const std::vector<char>& faces_left_out) const;

  // The solid moved by `shift`.
  SolidModel Translated(const Eigen::Vector3d& shift) const;
};

// The borders of its faces, for TessellateShell.
std::vector<FaceBorder> BordersOf(const SolidModel& solid);

// How well the faces of a solid meet.
struct SolidAudit {
  double gap = 0;         // greatest distance of the two faces of an edge, and of either from it
  double edge_angle = 0;  // greatest angle of normals across an edge that is not sharp, radians
  Eigen::Vector3d edge_angle_at = Eigen::Vector3d::Zero();
  int sharp_edges = 0;
  double sharp_length = 0;                     // of all of them
  double least_sharp = 0, greatest_sharp = 0;  // angles across them in their middles, radians
  double turn = 0;    // greatest angle of neighbouring samples' normals inside a face
  Eigen::Vector3d turn_at = Eigen::Vector3d::Zero();
  double volume = 0;  // enclosed, by quadrature over the faces
  double area = 0;
  int open_edges = 0;      // that do not belong to two faces in opposite directions
  double open_length = 0;  // of them, along their curves
};

// Samples every edge at `samples` even places of each knot span, 2^-1 … 2^-12 of the first and last
// spans among them, and every face on a grid of that many in each span and so near to its corners.
SolidAudit AuditSolid(const SolidModel& solid, int samples = 6);

}  // namespace batten
