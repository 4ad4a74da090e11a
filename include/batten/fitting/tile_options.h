// SPDX-License-Identifier: MIT
// Options and results of fits of very many control points.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "batten/fitting/stream_options.h"

namespace batten {

struct TileOptions {
  int count_u = 0, count_v = 0;  // tiles; both 0: some 128 × 128 cells of the finest net to a tile
  Eigen::Index sample = 100000;  // points kept, ≥ 1000
  PassStore* store = nullptr;    // where finished passes are kept, if anywhere
};

// Throws std::invalid_argument naming the field whose value breaks its rule.
void Check(const TileOptions& options);

struct TiledFit {
  StreamedFit whole;  // one surface; report.tiles tells of each tile, v fastest
  // Knots of the surface at which tiles begin and end
  std::vector<double> breaks_u, breaks_v;
};

}  // namespace batten
