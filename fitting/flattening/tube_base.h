// SPDX-License-Identifier: MIT
// Flattening of a bent tube into a periodic strip, for the parameters of a surface fit.
#pragma once

#include <Eigen/Core>
#include <string>

#include "batten/fitting/cloud_statistics.h"
#include "batten/fitting/neighbours.h"
#include "batten/fitting/progress.h"
#include "batten/geometry/thread_pool.h"

namespace batten::internal {

struct TubeBase {
  // Parameters (2 × m): u round the tube in [0, length_u), periodic; v along it in [0, length_v],
  // widened by the margin. They are lengths on the tube, averaged where these differ. A smooth
  // function of the point; (u, v, outwards) is right-handed.
  Eigen::Matrix2Xd parameters;
  PointMask reached;  // false where a point stands off the tube: its parameters are a guess
  double length_u = 0, length_v = 0;
  double distortion = 0;  // relative change of lengths, root mean square
  double folded = 0;      // share of the nodes at which the flattening is turned over
  double overlap = 0;     // share of the nodes that lie on another part of the flattened tube
  double share = 0;       // share of the nodes in the largest connected component
  int loops = 0;          // independent loops: one on a tube
  bool orientation_consistent = true;  // false: one-sided, as a Möbius band
  bool straight_ends = false;          // the ends of the cloud were laid on lines of constant v
  Eigen::Index nodes = 0;
  std::string why;             // one clause on what it is
  std::string failure_reason;  // empty when the tube serves, else why not and what to do

  bool ok() const { return failure_reason.empty(); }
};

struct TubeBaseOptions {
  Eigen::Index nodes = 2000;  // about; more where the tube is thin
  double most_distortion = 0.4;
  double most_folded = 0.002;
  double most_overlap = 0.01;
  double least_share = 0.9;
};

// Flattens the tube that distinct points lie on: any bent pipe, hose or horn with two open ends and
// any section. That it closes round is decided by loops of the graph of its nodes, not by gaps;
// holes may be as long round as half the tube is. It needs some 16 nodes round, and turns of a coil
// may come within about three spacings of each other. Points should be rid of outliers. `spacing`
// and `noise` are those of MeasureCloud. Each attempt has a finer resolution than the one before;
// the first that serves is returned, else the last with its failure reason. Parameters are always
// finite and inside. Bit for bit the same for every number of threads. Throws
// std::invalid_argument unless there are points and index, spacing, noise and margin fit them;
// Cancelled when progress asks to stop. O(m log m).
TubeBase FlattenTube(const Eigen::Matrix3Xd& points,
                     const NeighbourIndex& index,
                     double spacing,
                     double noise,
                     double margin,
                     const TubeBaseOptions& options,
                     ThreadPool& pool,
                     const Progress& progress = {});

}  // namespace batten::internal
