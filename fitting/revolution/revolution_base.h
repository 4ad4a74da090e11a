// SPDX-License-Identifier: MIT
// Surfaces of revolution, spheres and tori as bases of a closed cloud.
#pragma once

#include <Eigen/Core>

#include "batten/fitting/neighbours.h"
#include "batten/fitting/progress.h"
#include "batten/geometry/thread_pool.h"
#include "fitting/revolution/round_cloud.h"
#include "fitting/revolution/round_parameters.h"

namespace batten::internal {

// Fits a surface of revolution: axis and profile by least squares, both directions open or closed.
// A direction is closed if paths along the neighbour graph of the nodes go round; a spiral has
// none. An end of the profile within three spacings of the axis is a pole. Open directions cover
// the points, widened by the margin. Points (3 × m) are distinct and almost rid of outliers;
// spacing and noise are those of MeasureCloud. The cloud's way round is known and, but for a
// sphere's base, its shape. Bit for bit the same for every number of threads.
// O(m log m).
RevolutionParameterization RevolutionBaseOf(const RoundCloud& cloud, ThreadPool& pool);

// Fits a sphere; its poles lie where the data leave the most area open, else on a coordinate axis.
RevolutionParameterization SphereBaseOf(const RoundCloud& cloud, ThreadPool& pool);

// Fits a torus whose axis does not meet its tube and whose tube is covered by more than half.
RevolutionParameterization TorusBaseOf(const RoundCloud& cloud, ThreadPool& pool);

}  // namespace batten::internal
