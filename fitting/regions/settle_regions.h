// SPDX-License-Identifier: MIT
// Borders of regions: points go to the shape that explains them best, neighbours that one shape
// explains become one.
#pragma once

#include <Eigen/Core>
#include <map>
#include <utility>
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
// hangs together, and what is smaller than kFewestPoints is left out; shapes are fitted again to
// points away from borders, of the simplest kind that those do not reject; regions that touch and
// that one shape explains are joined. Repeated until the regions stay. [Cohen-Steiner, Alliez &
// Desbrun 2004; Besag 1986]
void SettleRegions(const RegionPoints& data, double sigma, RegionLabels& labels, ThreadPool& pool);

// Members of a region whose feet are farther than noise from the shapes of the regions about it:
// they are of this region for certain, whatever their own distances.
std::vector<int> CorePoints(const RegionPoints& data,
                            const RegionLabels& labels,
                            int region,
                            double sigma);

using Component = std::vector<int>;  // points of one label that hang together

// Sets of `open` points, each with the open neighbours that are `linked` with one of its own. O(m).
template <typename Open, typename Linked>
std::vector<Component> ConnectedSets(const RegionPoints& data,
                                     const Open& open,
                                     const Linked& linked) {
  std::vector<Component> sets;
  std::vector<bool> seen(static_cast<std::size_t>(data.size()));
  for (int k = 0; k < static_cast<int>(data.size()); ++k) {
    if (seen[std::size_t(k)] || !open(k)) continue;
    Component part{k};
    seen[std::size_t(k)] = true;
    for (std::size_t i = 0; i < part.size(); ++i) {
      for (const int other : data.Around(part[i])) {
        if (seen[std::size_t(other)] || !open(other) || !linked(part[i], other)) continue;
        seen[std::size_t(other)] = true;
        part.push_back(other);
      }
    }
    sets.push_back(std::move(part));
  }
  return sets;
}

// All of them; points of no region are of none. O(m).
std::vector<Component> ComponentsOf(const RegionPoints& data, const std::vector<int>& label);

// Whether most of the points, of one label, have neighbours of another: those of a face a few
// spacings wide, whose neighbourhoods are not its own.
bool IsNarrow(const RegionPoints& data,
              const std::vector<int>& label,
              const std::vector<int>& points);

// Whether the shapes of two regions have nearly the same normals where the regions touch.
bool JoinSmoothly(const RegionPoints& data, const RegionLabels& labels, int a, int b);

// Two regions, the lower number first.
using RegionPair = std::pair<int, int>;

// Of regions that have neighbouring points the places halfway between these.
std::map<RegionPair, std::vector<Eigen::Vector3d>> LinksOf(const RegionPoints& data,
                                                           const std::vector<int>& label);

}  // namespace batten::internal
