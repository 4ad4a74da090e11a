// SPDX-License-Identifier: MIT
// Which places of a surface's domain a plane passes through, as chains of places. Internal to
// geometry.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "batten/geometry/foot_point.h"
#include "batten/geometry/nurbs_surface.h"

namespace batten::internal {

// A stretch of a section inside one cell of one pair of spans.
struct SectionLink {
  int from, to;          // numbers of nodes
  int patch_u, patch_v;  // the pair
  ParameterBox cell;
  bool over_v, over_u;  // u is a function of v along it, v one of u
};

struct SectionTrace {
  std::vector<Eigen::Vector2d> nodes;            // (u, v)
  std::vector<std::vector<SectionLink>> chains;  // each link begins where the one before ends
  // The edges u lower, u upper, v lower, v upper that lie in the plane.
  std::array<bool, 4> edges{};
  bool contains_patch = false;  // a whole patch lies in the plane to the tolerance
};

// The zero set of f = normal·S − offset, |normal| = 1, with the side f > 0 on the left of every
// chain. The domain is cut until every cell
//  (1) has one sign by the Bernstein coefficients of f,
//  (2) or f is monotone in u or in v there and has at most one zero on each side of the cell, or
//  (3) |f| ≤ tolerance all over it, or it is 2^-20 of a span wide.
// Where chains go follows from the signs of f at the corners of cells alone, each evaluated in one
// way; zero counts as positive. So chains never break, and what (3) can hide is within the
// tolerance of the plane. On an edge that lies in the plane, a pole on it for one, the sign is that
// of the derivative inwards. A patch that lies in the plane counts as positive.
// [the idea of certified cells: Plantinga & Vegter 2004]
SectionTrace TraceSection(const NurbsSurface& surface,
                          const Eigen::Vector3d& normal,
                          double offset,
                          double tolerance);

}  // namespace batten::internal
