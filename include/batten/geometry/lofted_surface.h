// SPDX-License-Identifier: MIT
// Surfaces through any number of section curves: lofting, also called skinning.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "batten/geometry/aligned_curves.h"
#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"

namespace batten {

// How the surface leaves the first section, or arrives at the last.
struct LoftEnd {
  Eigen::Vector3d direction;  // of ∂S/∂v there; its length does not count, and is not zero
  double fullness = 1;  // ∂S/∂v in mean lengths of the rows between first and last section
};

struct LoftOptions {
  // Across the sections; where there are too few for it, the highest they determine. Odd where
  // closed, 3 with a spine.
  int degree = 3;
  bool closed = false;  // goes on from the last section to the first, periodic and smooth there
  std::optional<LoftEnd> start = {}, end = {};
  // A curve past the sections in their order: they lie at its parameters nearest to their middles,
  // and the surface crosses each in the direction of the spine there.
  std::optional<NurbsCurve<3>> spine = {};
  bool align = false;  // sections as Aligned turns and begins them
  // Where weights differ too wildly from section to section, how far the polynomial sections that
  // stand for them may be off; 0: such sections are refused. In the data's units.
  double tolerance = 0;
};

struct LoftedSurface {
  NurbsSurface surface;
  std::vector<double> parameters;       // v of each section
  std::vector<CurveAlignment> changes;  // made by `align`; one for each section
  double error = 0;                     // of the sections; 0: they are met to rounding
};

// u runs along the sections, v across them over [0, 1]; S(u, parameters[k]) is section k. Sections
// are made compatible (compatible_curves.h), so that the net has as many rows as all their knots
// need. Parameters are the mean over all rows of control points of the shares of their chord
// lengths; rows that are one point do not count. Knots are averaged from them.
//
// Weights: sections are scaled to mean weight one. Where their weights are then in proportion, each
// row has one weight and control points are interpolated as they are. Otherwise sections are traced
// anew so that their end weights are one, and homogeneous control points are interpolated; the
// result is taken where every weight stays within half the least and twice the greatest of its row;
// where not, the surface would swing between the sections for weights' sake: sections are then
// replaced by cubics within `tolerance`.
//
// Throws std::invalid_argument naming section and measure: fewer than two sections, or three where
// closed; closed sections beside open ones; two that follow one another and are the same; all on
// one line; an end given where closed, of no direction, or at degree 1; a spine that does not pass
// the sections in their order; wild weights without a tolerance. O(rows · sections) beside the
// common knots. [Piegl & Tiller 1997, §10.3; Woodward 1988]
LoftedSurface Loft(const std::vector<NurbsCurve<3>>& sections, const LoftOptions& options = {});

}  // namespace batten
