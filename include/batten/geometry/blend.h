// SPDX-License-Identifier: MIT
// Curves between the ends of two curves, surfaces between the edges of two surfaces.
#pragma once

#include <array>
#include <optional>

#include "batten/geometry/joins.h"
#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"

namespace batten {

struct BlendOptions {
  int continuity = 2;  // k of G^k at both ends, 0 … 2
  // How far the shapes' directions are followed, at either end, in (0, 100]: the speed there in
  // widths of the gap. About 1 is even; small is tight, large is full.
  std::array<double, 2> fullness = {1, 1};
};

struct CurveEnds {
  bool first_upper = true, second_upper = false;
};

// The Bézier curve of degree 2k + 1 on [0, 1] from an end of the first to an end of the second
// curve: Hermite's in homogeneous coordinates, the speed that the fullness says, no change of speed
// at its ends. Ends unset: the nearest pair. Throws std::invalid_argument unless the options are in
// their range, the ends differ, the curves do not rest there, and the weights come out positive
// (take less fullness). O(p²).
template <int Dim>
NurbsCurve<Dim> Blend(const NurbsCurve<Dim>& first,
                      const NurbsCurve<Dim>& second,
                      const BlendOptions& options = {},
                      std::optional<CurveEnds> ends = {});

struct SurfaceBlend {
  NurbsSurface surface;              // u from the first's edge at 0 to the second's at 1
  std::array<SurfaceEdge, 2> edges;  // which they are
  bool reversed = false;             // the second's edge runs against the first's
};

// The same between edges of two surfaces; v runs along both at once, from end to end, over the
// merged knots of both edges. Equal parameters are joined: reparameterize one where that twists.
// The joints are G^k along the whole edge: across it the derivatives are the surface's own times a
// constant, in homogeneous coordinates (JoinFreedom: beta of the fullness, eta that holds the
// weights level). Edges unset: those whose mean distance at equal shares of their domains is least,
// of all 16 pairs, edges that are points left out, and pairs of a closed edge and an open one.
// Throws as above, where a surface is trimmed, and where no pair is left.
SurfaceBlend Blend(const NurbsSurface& first,
                   const NurbsSurface& second,
                   const BlendOptions& options = {},
                   std::optional<SurfaceEdge> first_edge = {},
                   std::optional<SurfaceEdge> second_edge = {});

}  // namespace batten
