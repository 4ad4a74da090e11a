// SPDX-License-Identifier: MIT
// Surface interpolation of all points of a grid, global or local.
#pragma once

#include <Eigen/Core>

#include "batten/fitting/grid_data.h"
#include "batten/fitting/grid_parameters.h"
#include "batten/geometry/nurbs_surface.h"
#include "batten/geometry/thread_pool.h"

namespace batten {

enum class GridKnots {
  kAveraged,  // means of p neighbouring parameters
  kNearEnds,  // the same, but of cubics the first and last inner knots six tenths between the
              // second and third parameters: on grids fine enough for their shape errors along
              // edges fall, which are the largest otherwise
};

struct GridInterpolationOptions {
  int degree_u = 3, degree_v = 3;  // 1 … 25
  GridParameterization parameterization = GridParameterization::kAuto;
  GridParameters parameters = {};  // for kGiven: one a line and, of closed directions, one more
  GridKnots knots = GridKnots::kNearEnds;
  GridClosing closed = {};  // goes on from the last line to the first, C^{p−1} everywhere
};

struct InterpolatedGrid {
  NurbsSurface surface;
  GridParameters parameters;  // of the lines, in the surface's domain: there it meets the points
};

// Interpolates all points by a surface of the given degrees, solved as a tensor product: one banded
// matrix a direction for all right-hand sides. Meets its points to rounding times the condition of
// the matrices, which grows with the degree; corners of open directions exactly. Lines that
// collapse to a point (poles) stay collapsed. O(rows·columns·(p + q)). Throws
// std::invalid_argument, with a sentence for the user, where cells are missing, there are fewer
// lines than degree + 1 (closed: 3) in a direction, or neighbouring lines lie in one place. [Piegl
// & Tiller 1997, A9.4]
InterpolatedGrid InterpolateGrid(const PointNet& net,
                                 const GridInterpolationOptions& options,
                                 ThreadPool& pool);

// Interpolates all points by the bicubic C¹ surface that has Bessel's tangents at each point, those
// of parabolas through neighbours, and their twist: a point affects the 4 × 4 cells around it only.
// Knots are double, control points 2·rows × 2·columns; degrees and knots of the options are
// ignored. O(rows·columns). Throws std::invalid_argument, with a sentence for the user, where cells
// are missing, a direction is to close, or neighbouring lines lie in one place. [Piegl & Tiller
// 1997, §9.3.5, A9.5]
InterpolatedGrid InterpolateGridLocally(const PointNet& net,
                                        const GridInterpolationOptions& options,
                                        ThreadPool& pool);

}  // namespace batten
