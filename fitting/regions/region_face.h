// SPDX-License-Identifier: MIT
// The face that a region's points make: its numbers with standard deviations, and the trimmed patch
// they cover.
#pragma once

#include <optional>
#include <vector>

#include "batten/fitting/part_options.h"
#include "batten/geometry/thread_pool.h"
#include "fitting/primitives/fitted_surface.h"
#include "fitting/regions/region_points.h"

namespace batten::internal {

// The points of a region, and those of them that count in its fit.
struct RegionFace {
  FittedSurface shape;  // in the units of RegionPoints
  std::vector<int> points, core;
  PrimitiveSummary numbers;  // in the coordinates of the result
  std::vector<std::string> warnings = {};
};

// The least-squares fit of the region's kind to its core, as FitPrimitive makes it. `move` is what
// coordinates of the cloud gain in the result. None where the points do not determine one.
std::optional<RegionFace> FittedFace(const RegionPoints& data,
                                     const FittedSurface& shape,
                                     std::vector<int> points,
                                     std::vector<int> core,
                                     const Eigen::Vector3d& move,
                                     std::uint64_t seed,
                                     ThreadPool& pool);

// Whether the points tell radii and angles to a third, directions to 11°: else any other shape
// would do as well.
bool Determined(const RegionFace& face);

// The numbers of the face with another shape of its kind; its standard deviations stay.
void TakeShape(const RegionPoints& data,
               const FittedSurface& shape,
               const Eigen::Vector3d& move,
               RegionFace& face);

// The part of the face's shape that all its points cover, trimmed to their outline where that is
// not the whole of it.
PartFace CoveredFace(const RegionPoints& data,
                     const RegionFace& face,
                     const Eigen::Vector3d& move,
                     std::vector<std::string>& warnings,
                     ThreadPool& pool);

// x → scale · x + shift.
FittedSurface Placed(FittedSurface shape, double scale, const Eigen::Vector3d& shift);

}  // namespace batten::internal
