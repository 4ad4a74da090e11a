// SPDX-License-Identifier: MIT
// Surfaces at a distance from others.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "batten/geometry/nurbs_surface.h"
#include "batten/geometry/offset_options.h"

namespace batten {

// Where an offset surface meets itself.
struct SurfaceSelfMeeting {
  Eigen::Vector2d first, second;
  Eigen::Vector3d point;
};

struct SurfaceOffset {
  NurbsSurface surface;
  bool exact = false;
  double deviation = 0;  // measured at 25 places between knots, at equal parameters; 0 where exact
  bool tolerance_reached = true;
  std::vector<SurfaceSelfMeeting> self_meetings;  // at most 100 places
};

// The surface S + d·n, n the unit normal S_u × S_v / |…| and its limits at poles. Planes, spheres
// and cylinders of any parameter, and cones and tori as MakeCone and MakeTorus make them, keep
// their form exactly. All else becomes the bicubic that interpolates at Greville places, over knots
// that are the surface's own, one smoothness less, and as many between as the tolerance needs; up
// to 400 rows, then the nearest found is given. Parameters and trims stay.
//
// Throws std::invalid_argument where the distance is zero or not finite, the tolerance not
// positive, where there is no normal, at a crease (naming the knot), and where the distance is
// beyond a radius of curvature on its side: the message names the smallest radius and its place.
// Curvatures are sampled at 25 places a cell and followed to their greatest.
SurfaceOffset OffsetSurface(const NurbsSurface& surface,
                            double distance,
                            const OffsetOptions& options = {});

}  // namespace batten
