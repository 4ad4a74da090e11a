// SPDX-License-Identifier: MIT
// Surfaces through a network of curves in two directions.
#pragma once

#include <vector>

#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"

namespace batten {

struct GordonOptions {
  // How far apart curves may be where they meet, and how far the surface may be from curves that
  // had to be traced anew, in the data's units, above 0.
  double tolerance = 0;
};

struct GordonSurface {
  NurbsSurface surface;
  std::vector<double> u, v;  // parameters of the curves across u, and along u, in order
  std::vector<int> order_u;  // order_u[k]: which of `along_u` lies at v[k]
  std::vector<int> order_v;  // which of `along_v` lies at u[l]
  double gap;                // largest distance of two curves where they meet
  double error;              // curves traced anew are met to that; 0: as they were given
};

// The surface that contains all curves: the one lofted through those along u, plus the one lofted
// through those along v, less the one through the points where they meet, all interpolated alike
// (cubic, or what two or three curves allow). S(·, v[k]) is curve order_u[k] of `along_u`, S(u[l],
// ·) is curve order_v[l] of `along_v`, to rounding, the gap and the error.
//
// Curves may come in any order and direction, and may overhang the network: what overhangs is cut
// off. Meeting points are found. Where a curve meets the others at other parameters than its
// neighbours do, by more than a tenth of the tolerance, its direction is traced anew, by a monotone
// C^2 map of its parameter (C^1 where none is monotone), as a cubic within the tolerance; so are
// curves with weights. Where the curves of one direction are closed, so is the surface, and smooth
// there.
//
// Throws std::invalid_argument naming curves, measured gap and rule: fewer than two curves in a
// direction, closed curves beside open ones, two across one another that do not meet within the
// tolerance or meet in several places, two beside one another that do meet, curves that meet the
// others in another order. O(curves² · samples² + net).
// [Gordon 1969; Piegl & Tiller 1997, §10.5; Fritsch & Carlson 1980 for the map]
GordonSurface Gordon(const std::vector<NurbsCurve<3>>& along_u,
                     const std::vector<NurbsCurve<3>>& along_v,
                     const GordonOptions& options);

}  // namespace batten
