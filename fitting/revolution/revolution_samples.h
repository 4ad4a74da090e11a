// SPDX-License-Identifier: MIT
// Samples that every round base is fitted to: nodes, consistently oriented normals, and a graph.
#pragma once

#include <Eigen/Core>
#include <string>

#include "batten/fitting/neighbours.h"
#include "batten/geometry/thread_pool.h"
#include "fitting/flattening/sheet_graph.h"

namespace batten::internal {

// Sizes of the nodes: spheres and tubes of a larger radius are none.
inline constexpr double kFarAway = 1e3;

// Nodes of a cloud, computed once for all bases that are tried over it.
struct RevolutionSamples {
  SheetGraph graph;                                  // normals mostly point outwards
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  // of the nodes
  double noise = 0;                                  // of the points
  double size = 0;             // root mean square distance of the nodes from the centre
  std::string failure_reason;  // empty if the nodes serve, else why not and what to do

  const PoissonDiskSamples& nodes() const { return graph.nodes; }
  Eigen::Index count() const { return graph.nodes.size(); }
  bool ok() const { return failure_reason.empty(); }
};

// Samples nodes of points (3 × m) that are distinct and almost rid of outliers; `noise` is their
// standard deviation along the normal. If strict edges leave the shape in several components, as
// along a sharp rim, edges may turn by more. The same for every order of the points up to rounding,
// and bit for bit for every number of threads. O(m log m).
RevolutionSamples SampleRevolution(const Eigen::Matrix3Xd& points,
                                   const NeighbourIndex& index,
                                   double noise,
                                   ThreadPool& pool);

// Uses nodes chosen before.
RevolutionSamples RevolutionSamplesOf(const PoissonDiskSamples& nodes, double noise);

}  // namespace batten::internal
