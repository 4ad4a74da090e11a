// SPDX-License-Identifier: MIT
// What every base of a round shape is found from: nodes, normals that agree, and their graph.
#pragma once

#include <Eigen/Core>
#include <string>

#include "batten/fitting/neighbours.h"
#include "batten/geometry/thread_pool.h"
#include "fitting/flattening/sheet_graph.h"

namespace batten::internal {

// Made once for a cloud, whatever bases are then tried over it.
struct RevolutionSamples {
  SheetGraph graph;                                  // normals look outwards on the whole
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  // of the nodes
  double noise = 0;                                  // of the points
  double size = 0;             // root of the mean square of their distances from it
  std::string failure_reason;  // empty when they serve, else why not and what to do

  const PoissonDiskSamples& nodes() const { return graph.nodes; }
  Eigen::Index count() const { return graph.nodes.size(); }
  bool ok() const { return failure_reason.empty(); }
};

struct RevolutionSampleOptions {
  Eigen::Index nodes = 2000;  // about
  double least_share = 0.9;   // of them in one part
};

// Points (3 × m) are distinct and almost rid of outliers; `noise` is their standard deviation along
// the normal. Where strict edges leave the shape in several parts, as along a sharp rim, edges may
// turn by more. The same for every order of the points up to rounding, and bit for bit for every
// number of threads. O(m log m).
RevolutionSamples SampleRevolution(const Eigen::Matrix3Xd& points,
                                   const NeighbourIndex& index,
                                   double noise,
                                   const RevolutionSampleOptions& options,
                                   ThreadPool& pool);

// The same of nodes chosen before, as many as the options ask for.
RevolutionSamples RevolutionSamplesOf(const PoissonDiskSamples& nodes,
                                      double noise,
                                      const RevolutionSampleOptions& options);

}  // namespace batten::internal
