// SPDX-License-Identifier: MIT
// Surfaces of revolution, spheres and tori as what the parameters of a closed cloud are taken from.
#pragma once

#include <Eigen/Core>

#include "batten/fitting/neighbours.h"
#include "batten/fitting/progress.h"
#include "batten/geometry/thread_pool.h"
#include "fitting/revolution/round_cloud.h"
#include "fitting/revolution/round_parameters.h"

namespace batten::internal {

struct RevolutionParameterizationOptions {
  Eigen::Index nodes = 2000;  // about
  double least_share = 0.9;   // of the nodes in one part
  double most_misfit = 0.09;  // a ripple of amplitude 0.1 has 0.07, a cube 0.11
  double least_closed = 0.5;  // of the profile's places gone round wholly, of what counts as closed
};

// A surface of revolution: axis and profile by least squares, both directions open or closed.
// Closed means that along the neighbour graph of the nodes ways lead round; a spiral has none.
// Where the profile comes to the axis within three spacings, that end is a pole. Open directions
// reach over the points, widened by the margin. Points (3 × m) are distinct and almost rid of
// outliers; `spacing` and `noise` are those of MeasureCloud. Parameters are finite and inside even
// with a refusal. Bit for bit the same for every number of threads. Throws std::invalid_argument
// unless there are points and index, spacing, noise and margin fit them; Cancelled when progress
// asks to stop. O(m log m).
RevolutionParameterization FindRevolutionBase(const Eigen::Matrix3Xd& points,
                                              const NeighbourIndex& index,
                                              double spacing,
                                              double noise,
                                              double margin,
                                              const RevolutionParameterizationOptions& options,
                                              ThreadPool& pool,
                                              const Progress& progress = {});

// A sphere; poles lie where the data leave the most open, else on a coordinate axis.
RevolutionParameterization FindSphereBase(const Eigen::Matrix3Xd& points,
                                          const NeighbourIndex& index,
                                          double spacing,
                                          double noise,
                                          double margin,
                                          const RevolutionParameterizationOptions& options,
                                          ThreadPool& pool,
                                          const Progress& progress = {});

// A torus whose axis does not meet its tube, of which more than half goes round.
RevolutionParameterization FindTorusBase(const Eigen::Matrix3Xd& points,
                                         const NeighbourIndex& index,
                                         double spacing,
                                         double noise,
                                         double margin,
                                         const RevolutionParameterizationOptions& options,
                                         ThreadPool& pool,
                                         const Progress& progress = {});

// The same, several of them over one cloud.
RevolutionParameterization RevolutionBaseOf(const RoundCloud& cloud,
                                            const RevolutionParameterizationOptions& options,
                                            ThreadPool& pool);
RevolutionParameterization SphereBaseOf(const RoundCloud& cloud,
                                        const RevolutionParameterizationOptions& options,
                                        ThreadPool& pool);
RevolutionParameterization TorusBaseOf(const RoundCloud& cloud,
                                       const RevolutionParameterizationOptions& options,
                                       ThreadPool& pool);

}  // namespace batten::internal
