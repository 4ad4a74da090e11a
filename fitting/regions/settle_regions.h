// SPDX-License-Identifier: MIT
// Borders of regions: points go to the shape that explains them best, neighbours that one shape
// explains become one.
#pragma once

#include <vector>

#include "batten/geometry/thread_pool.h"
#include "fitting/regions/grow_regions.h"

namespace batten::internal {

// Standard deviations from a shape: farther off, a point is of no region and counts in no sum.
inline constexpr double kFarPoint = 4.5;

// Standard deviations: shapes that are no farther apart can't be told from one another.
inline constexpr double kApart = 4;

// Every point chooses among its own and its neighbours' regions by (d/σ)²/2, the turn of its normal
// and a price for each neighbour of another region, until none changes; regions fall into what
// hangs together, and what is smaller than `fewest` points is left out; shapes are fitted again to
// points away from borders, of the simplest kind that those do not reject; regions that touch and
// that one shape explains are joined. Repeated until the regions stay. [Cohen-Steiner, Alliez &
// Desbrun 2004; Besag 1986]
void SettleRegions(
    const RegionPoints& data, double sigma, int fewest, RegionLabels& labels, ThreadPool& pool);

// Members of a region whose feet are farther than noise from the shapes of the regions about it:
// they are of this region for certain, whatever their own distances.
std::vector<int> CorePoints(const RegionPoints& data,
                            const RegionLabels& labels,
                            int region,
                            double sigma);

using Component = std::vector<int>;  // points of one label that hang together

// All of them; points of no region are of none. O(m).
std::vector<Component> ComponentsOf(const RegionPoints& data, const std::vector<int>& label);

// Whether most of the points, of one label, have neighbours of another: those of a face a few
// spacings wide, whose neighbourhoods are not its own.
bool IsNarrow(const RegionPoints& data,
              const std::vector<int>& label,
              const std::vector<int>& points);

// Whether the shapes of two regions have nearly the same normals where the regions touch.
bool JoinSmoothly(const RegionPoints& data, const RegionLabels& labels, int a, int b);

// Regions that have neighbouring points, with their number of pairs, by region.
std::vector<std::vector<std::pair<int, int>>> TouchingRegions(const RegionPoints& data,
                                                              const RegionLabels& labels);

}  // namespace batten::internal
