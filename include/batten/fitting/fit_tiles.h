// SPDX-License-Identifier: MIT
// Surfaces of very many control points, tile by tile.
#pragma once

#include <vector>

#include "batten/fitting/point_source.h"
#include "batten/fitting/surface_options.h"
#include "batten/fitting/tile_options.h"

namespace batten {

// Fits one surface over an open base (a plane, a sheet) to points that are passed over, of up to
// options.max_control_points, which is meant to be many (10^6).
//  1. a pass counts and keeps a sample, whose fit gives the base (as FitStreamed);
//  2. a pass finds the rectangle of parameters, which is cut into tiles;
//  3. a pass folds every point into moments of the cells of the finest net that the points (four to
//     a cell) and the options allow. Moments of coarser cells follow from them exactly;
//  4. nets of half, a quarter … as many cells a direction are solved, coarse to fine, each by
//     conjugate gradients over boxes that overlap, to 1e-13 of the right-hand side. Each tile wants
//     the one that generalised cross-validation of its own points prefers; a column (row) of tiles
//     gets the finest that one of its tiles wants, because knots run through. That net is solved;
//  5. a last pass measures every point.
// Over other bases than planes, 3 and 4 are done twice, for the surface's own foot points.
//
// With options.control_points the net is uniform, of so many. With a tolerance a tile wants the
// coarsest net whose cells keep it, as far as noise lets them. Points farther off than the sample's
// outliers begin have no weight. Memory: some 3 kB a cell of the finest net over a plane.
//
// Throws std::invalid_argument as FitStreamed, and for closed bases and more tiles than cells.
TiledFit FitTiles(PointSource& source,
                  const SurfaceFitOptions& options = {},
                  const TileOptions& tiles = {});

// The surface cut into its tiles, v fastest. Faces that meet share control points along the edge,
// and are parts of one surface: as smooth across as that is at its knots. Tiles without points have
// no face; of a trimmed surface those in which nothing counts neither, and those of several parts
// have one for each.
std::vector<NurbsSurface> TileFaces(const TiledFit& fit);

}  // namespace batten
