// SPDX-License-Identifier: MIT
// Flattening of a bent tube into a periodic strip, for the parameters of a surface fit.
#pragma once

#include <Eigen/Core>

#include "batten/fitting/progress.h"
#include "batten/geometry/thread_pool.h"
#include "fitting/flattening/flattened_base.h"

namespace batten::internal {

// Flattens the tube that distinct points lie on, with u round it in [0, length_u), periodic, and v
// along it in [0, length_v], widened by the margin; lengths are averaged where they differ, and
// (u, v, outwards) is right-handed: any bent pipe, hose or horn with two open ends and
// any section. That it closes round is decided by loops of the graph of its nodes, not by gaps;
// holes may be as long round as half the tube is. It needs some 16 nodes round, and turns of a coil
// may come within about three spacings of each other. Points should be rid of outliers. `spacing`
// and `noise` are those of MeasureCloud. Each attempt has a finer resolution than the one before;
// the first that serves is returned, else the last with its failure reason. Parameters are always
// finite and inside. Bit for bit the same for every number of threads. Throws
// std::invalid_argument unless there are points and index, spacing, noise and margin fit them;
// Cancelled when progress asks to stop. O(m log m).
FlattenedBase FlattenTube(const Eigen::Matrix3Xd& points,
                          const NeighbourIndex& index,
                          double spacing,
                          double noise,
                          double margin,
                          ThreadPool& pool,
                          const Progress& progress = {});

}  // namespace batten::internal
