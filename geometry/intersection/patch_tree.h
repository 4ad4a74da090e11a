// SPDX-License-Identifier: MIT
// A surface as a tree of halved Bézier patches with what their nets prove. Internal to geometry.
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "batten/geometry/nurbs_surface.h"
#include "batten/geometry/parameter_box.h"
#include "geometry/bezier/spline_pieces.h"
#include "geometry/intersection/net_cone.h"

namespace batten::internal {

// A rectangle of one Bézier patch.
struct NetPatch {
  ParameterBox box;
  int piece;                       // number of the Bézier patch
  Eigen::Matrix4Xd net;            // (w·P, w)
  Eigen::Matrix3Xd points;         // P
  Eigen::AlignedBox3d bounds;      // of the points
  DirectionCone along_u, along_v;  // of S_u and S_v
  DirectionCone normal;
  Eigen::Vector3d middle, half_u, half_v;  // S, and S_u and S_v times half the sides of the box
  double flatness;        // half the extent along the normal; the size where there is none
  double size_u, size_v;  // the longest rows of the net, in the data's units
  int children = -1;      // the first of two

  double size() const { return std::max(size_u, size_v); }
  Eigen::Vector2d Middle() const { return {box.u0 / 2 + box.u1 / 2, box.v0 / 2 + box.v1 / 2}; }
};

class PatchTree {
 public:
  // The surface is moved by −origin. O(pieces).
  PatchTree(const NurbsSurface& surface, const Eigen::Vector3d& origin);

  int roots() const { return roots_; }
  const NetPatch& operator[](int k) const { return patches_[k]; }
  // The number of the first of the two halves of a patch, across its longer side.
  int Halve(int k);

  // The largest box about a patch that holds no knot of a multiplicity of the degree or more
  // inside.
  const ParameterBox& SmoothBoxOf(int patch) const { return smooth_[patches_[patch].piece]; }

  // Point and derivatives at a place of a smooth box or a little beyond it: the nearest piece of
  // the box goes on. Nothing is added to the derivatives for the origin's sake.
  SurfaceJet JetAt(const ParameterBox& smooth, double u, double v) const;

  Eigen::Vector3d PointAt(const ParameterBox& smooth, double u, double v) const;

  // The diagonal of the box of the control points.
  double size() const { return size_; }

 private:
  void AddRoot(const SurfacePiece& piece);
  void Measure(NetPatch& patch) const;
  const SurfacePiece& PieceAt(const ParameterBox& smooth, double u, double v) const;

  std::vector<double> breaks_u_, breaks_v_;
  std::vector<SurfacePiece> pieces_;
  std::vector<ParameterBox> smooth_;
  std::vector<NetPatch> patches_;
  int p_, q_, roots_ = 0;
  double size_ = 0;
};

// Whether no point of the one is within `gap` of a point of the other, by their boxes and by their
// extents along their normals and along the line in which their planes meet.
bool Separated(const NetPatch& a, const NetPatch& b, double gap);

}  // namespace batten::internal
