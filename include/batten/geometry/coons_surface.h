// SPDX-License-Identifier: MIT
// Surfaces between boundary curves.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"

namespace batten {

struct CoonsOptions {
  // How far apart the ends of curves may be that meet at a corner, and how far the surface may be
  // from curves with weights that had to be replaced; data's units, above 0.
  double tolerance = 0;
  // Blended by cubics, with tangents across the boundaries, in place of straight lines.
  bool bicubic = false;
  // Of `bicubic`: ∂S/∂v along v = 0 and v = 1, ∂S/∂u along u = 0 and u = 1, as vectors over [0, 1]
  // each. None: from the tangents of the neighbouring sides at the corners, blended by cubics, with
  // twists of zero.
  std::optional<std::array<NurbsCurve<3>, 4>> across = {};
};

struct CoonsSurface {
  NurbsSurface surface;
  double gap;  // largest distance of two ends at a corner; each end is moved by half of it at most
  double error;  // of curves that were replaced by cubics; 0: none was
};

// The surface between four curves that go round, or three, in any order and direction. The first
// curve is v = 0 as it runs, the one that goes on from its end u = 1. Of three the edge v = 1 is
// the corner where the other two meet, a pole. Domain [0, 1]².
//  · Bilinear: the two ruled surfaces between opposite sides less the bilinear one of the corners.
//    With weights in homogeneous coordinates, all corners of weight one (a Möbius map of the sides'
//    parameters makes them so), where every weight of the net is then at least a tenth of the least
//    given; else curves are replaced by cubics within the tolerance.
//  · Bicubic: the same with cubic Hermite blends of sides and derivatives across; sides with
//    weights are replaced by cubics.
// Throws std::invalid_argument naming sides, measured gap and rule: not three or four curves, a
// closed one among them, all on one line, ends that do not meet, and derivatives across that are
// not the tangents of the sides at the corners, or whose twists differ there, by more than 1e-6 of
// their size. [Coons 1967; Farin 2002, §22; Piegl & Tiller 1997, §10.6]
CoonsSurface Coons(const std::vector<NurbsCurve<3>>& sides, const CoonsOptions& options);

}  // namespace batten
