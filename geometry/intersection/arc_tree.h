// SPDX-License-Identifier: MIT
// A curve as a tree of halved Bézier arcs with what their nets prove. Internal to geometry.
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "batten/geometry/nurbs_curve.h"
#include "geometry/bezier/spline_pieces.h"
#include "geometry/intersection/net_cone.h"

namespace batten::internal {

// A stretch of one Bézier arc.
struct NetArc {
  double u0, u1;
  Eigen::Matrix4Xd net;     // (w·P, w)
  Eigen::Matrix3Xd points;  // P; z = 0 in the plane
  Eigen::AlignedBox3d bounds;
  DirectionCone tangent;
  double flatness;  // the greatest distance of a control point from the chord
  double size;      // the length of the control polygon, in the data's units
  int children = -1;

  double Middle() const { return u0 / 2 + u1 / 2; }
};

class ArcTree {
 public:
  // The curve is moved by −origin.
  template <int Dim>
  ArcTree(const NurbsCurve<Dim>& curve, const Eigen::Vector3d& origin);

  int roots() const { return roots_; }
  const NetArc& operator[](int k) const { return arcs_[k]; }
  int Halve(int k);  // the number of the first of the two halves

  double lower() const { return pieces_.front().u0; }
  double upper() const { return pieces_.back().u1; }
  // Point and first derivative, in the columns; of the piece that holds the parameter.
  Eigen::Matrix<double, 3, 2> JetAt(double u) const;

 private:
  std::vector<CurvePiece> pieces_;
  std::vector<NetArc> arcs_;
  int roots_;
};

extern template ArcTree::ArcTree(const NurbsCurve<2>&, const Eigen::Vector3d&);
extern template ArcTree::ArcTree(const NurbsCurve<3>&, const Eigen::Vector3d&);

}  // namespace batten::internal
