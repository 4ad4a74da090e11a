// SPDX-License-Identifier: MIT
// Poisson-disk samples (nodes) of a sheet: a few thousand places that represent all its points.
#pragma once

#include <Eigen/Core>

#include "batten/fitting/neighbours.h"
#include "batten/geometry/thread_pool.h"

namespace batten::internal {

// Nodes of a sheet, no two of which are nearer than their reach, with the tangent plane and the
// curvature of the sheet at each.
struct PoissonDiskSamples {
  Eigen::Matrix3Xd places;     // n of them, moved along the normal onto the sheet
  Eigen::Matrix3Xd normals;    // of length 1, each with a sign of its own
  Eigen::Matrix3Xd tangents;   // of length 1, normal to the normals
  Eigen::Matrix3Xd curvature;  // second derivatives (xx, xy, yy) of the height over the tangent
                               // plane, x along the tangent, y along normal × tangent
  Eigen::VectorXd reach;       // approximate distance to the next nodes: a radius
  Eigen::VectorXd breadth;     // breadth over length of the points around: small where they line up

  Eigen::Index size() const { return places.cols(); }
  Eigen::Vector3d Binormal(Eigen::Index i) const;
  // Whether most neighbourhoods are on a line: nothing then tells how a sheet runs between them.
  bool LieAlongLines() const;
  // Reverses the node's normal: the other side of the sheet becomes its upper one.
  void Flip(Eigen::Index i);
  PoissonDiskSamples Picked(const std::vector<Eigen::Index>& indices) const;
};

struct PoissonDiskOptions {
  Eigen::Index most = 2000;     // nodes, about
  int least_neighbours = 12;    // that a tangent plane is fitted to …
  int most_neighbours = 60;     // … and most
  bool own_neighbours = false;  // tangent planes from all points, and not from those that may
                                // become nodes: of nearer ones, where a sheet comes close to itself
  bool edges_first = false;     // nodes on the sheet's border are picked before all others, the
                                // outermost first and 0.65 reaches apart
};

// Samples a greedy Poisson-disk subset of the points, in an order that depends on their coordinates
// only. The distance of the nodes is chosen to give `most` of them, but is at least 1.5 local
// spacings and 4 times the noise; a node's normal is that of the best plane, its place the foot
// point on the best quadric over it. If there are few points, all are nodes. [RSA of discs fills
// 0.547 of the plane: Feder 1980] O(m) and about 50 neighbour searches a node.
PoissonDiskSamples SamplePoissonDisk(const Eigen::Matrix3Xd& points,
                                     const NeighbourIndex& index,
                                     double noise,
                                     const PoissonDiskOptions& options,
                                     ThreadPool& pool);

}  // namespace batten::internal
