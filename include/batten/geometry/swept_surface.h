// SPDX-License-Identifier: MIT
// Surfaces that a curve sweeps out, carried along another and turned with it.
#pragma once

#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"

namespace batten {

struct SweepOptions {
  double tolerance = 0;  // largest distance from the exact sweep, data's units, above 0
  double twist = 0;      // turned about the trajectory on the way, radians, evenly by its length
};

struct SweptSurface {
  NurbsSurface surface;
  double error;    // largest distance found from the exact sweep, at equal parameters
  double closing;  // turn spread over a closed trajectory so that the surface closes, radians
};

// The profile carried along the trajectory by its rotation-minimising frame: the exact sweep is
//   S(u,v) = T(v) + M(v)·(C(u) − T(start)),
// where M turns the frame at the start into that at v without turning it about the tangent. The
// profile stays where it is: v = start is the profile itself. Along a closed trajectory the frame
// comes back turned; that turn, at most half of one, is spread evenly over the length.
//
// The surface has the profile's basis and weights in u; in v it is a cubic, C^2 but where the
// trajectory is only C^1, through as many places as it takes for every point of it to be within the
// tolerance of the exact sweep: bounded for the whole profile by its control points, and looked at
// at eleven even places between any two. Lengths are those of the trajectory, so pace counts.
//
// Throws std::invalid_argument, saying where, if the trajectory has a kink (also at the seam of a
// closed one) or stands still, if the profile reaches beyond the trajectory's centre of curvature,
// so that the sweep folds back over itself, if it lies on a line along the trajectory, or turns
// back in a plane that holds the trajectory's tangent, so that the sweep has no area or lies on
// itself, for a twist along a closed trajectory that is not a whole number of turns, or if the
// tolerance needs more than 20,000 spans. [Wang, Jüttler, Zheng & Liu 2008, "Computation of
// rotation minimizing frames"]
SweptSurface Sweep(const NurbsCurve<3>& profile,
                   const NurbsCurve<3>& trajectory,
                   const SweepOptions& options);

}  // namespace batten
