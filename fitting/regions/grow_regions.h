// SPDX-License-Identifier: MIT
// Regions of a cloud that one plane, sphere, cylinder, cone or torus explains.
#pragma once

#include <optional>
#include <vector>

#include "batten/fitting/progress.h"
#include "batten/geometry/thread_pool.h"
#include "fitting/primitives/fitted_surface.h"
#include "fitting/regions/region_points.h"

namespace batten::internal {

inline constexpr int kNoRegion = -1;
inline constexpr int kFewestPoints = 30;  // of a region: four for each freedom of a torus
inline constexpr int kFewLinks = 4;  // pairs of points of two regions: fewer are chance at a corner

struct Region {
  FittedSurface shape;
  std::vector<int> points;  // ascending
};

// A region for each point, or none.
struct RegionLabels {
  std::vector<Region> regions;
  std::vector<int> label;  // kNoRegion: of none
};

// Adds a region and labels its points.
void Append(Region region, RegionLabels& labels);

// Sine: neighbours whose normals turn by more lie over an edge.
inline constexpr double kSameSheet = 0.35;

// Points that a shape explains are as many as those of another from this share of them on.
inline constexpr double kAsMany = 0.9;

// Faces with more than so many times the noise of others have noise of their own: a scanner's
// differs less from place to place.
inline constexpr double kNoisier = 10;

// Grows regions one after the other, from the free points whose neighbours' normals agree best.
// About each a shape of every kind is fitted to some thirty neighbours, and to what lies within
// noise of it and hangs together, until that grows no more; of the shapes that their points, away
// from their border, do not reject (TestShape) the simplest counts that explains nine tenths of
// what any explains. [Besl & Jain 1988; Schnabel, Wahl & Klein 2007] Regions have at least
// kFewestPoints. Does not depend on the number of threads.
RegionLabels GrowRegions(const RegionPoints& data,
                         double sigma,
                         const Progress& progress,
                         ThreadPool& pool);

// The first shape of plane, sphere, cylinder, cone and torus that the points do not reject.
std::optional<FittedSurface> SimplestShape(const RegionPoints& data,
                                           const std::vector<int>& members,
                                           double sigma,
                                           ThreadPool& pool);

}  // namespace batten::internal
