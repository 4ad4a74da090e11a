// SPDX-License-Identifier: MIT
// Points that are of a free surface: those of no region, and of regions that are pieces of one.
#pragma once

#include <vector>

#include "batten/geometry/thread_pool.h"
#include "fitting/regions/grow_regions.h"

namespace batten::internal {

// Takes their points from regions that end where nothing does. Any free surface is explained by
// tori piece by piece, as far as noise lets them reach; but where two such pieces join, a third
// over half of both is explained as well, while no shape goes across the border of two faces.
// Regions go whose smooth borders with regions or left-over points, of sizes that tell, are for the
// most part of that kind, two or more together: a test for a change of law at a given place.
// [Chow 1960]
void DissolvePieces(const RegionPoints& data, double sigma, RegionLabels& labels, ThreadPool& pool);

// Connected sets of at least `fewest` points of no region whose normals turn evenly: smooth pieces
// of no simple shape.
std::vector<std::vector<int>> SmoothLeftovers(const RegionPoints& data,
                                              const std::vector<int>& label,
                                              int fewest);

}  // namespace batten::internal
