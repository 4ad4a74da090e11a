// SPDX-License-Identifier: MIT
// What two surfaces have in common.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/parameter_box.h"

namespace batten {

enum class BranchKind {
  kTransversal,  // the surfaces cross
  kTangential,   // they touch along it
  kOverlap       // an edge of a region in which they coincide
};
// "transversal", "tangential", "overlap"
const char* NameOf(BranchKind kind);

// A curve along which two surfaces meet. All curves have the same parameter, about arc length:
// on_first[k].At(t) and on_second[k].At(t) are where on the surfaces curve.At(t) is.
struct SurfaceBranch {
  BranchKind kind = BranchKind::kTransversal;
  bool closed = false;  // in space
  // Cubic and C¹; a corner, where a surface has a crease, is a knot of multiplicity 3.
  NurbsCurve<3> curve;
  // In the domains, over consecutive parts of the curve's domain: one each, unless the branch
  // runs over a seam, where the next goes on from the other edge. None for an overlap along a seam
  // of that surface.
  std::vector<NurbsCurve<2>> on_first, on_second;
  // The greatest distance of the curve from either surface at equal parameters, measured at nine
  // places between any two knots.
  double deviation = 0;
};

// A place where the surfaces touch and do not cross, or where branches cross each other.
struct SurfaceTouch {
  Eigen::Vector3d point;
  Eigen::Vector2d on_first, on_second;
  bool on_branch = false;  // a branch passes
};

// A region in which the surfaces are the same to the tolerance: boxes that hold it.
struct SurfaceOverlap {
  ParameterBox first, second;
  Eigen::Vector3d point;  // one place of it
};

struct SurfaceIntersection {
  std::vector<SurfaceBranch> branches;
  std::vector<SurfaceTouch> touches;
  std::vector<SurfaceOverlap> overlaps;
  double tolerance = 0;  // what was worked with
};

}  // namespace batten
