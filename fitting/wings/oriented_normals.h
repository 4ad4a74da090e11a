// SPDX-License-Identifier: MIT
// Normals of a cloud with one sign along its sheets, and where they are to be trusted.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "batten/fitting/neighbours.h"
#include "batten/geometry/thread_pool.h"

namespace batten::internal {

// Neighbours that give a point's plane, and those that it is linked with; itself included.
inline constexpr int kOfPlane = 13, kOfGraph = 9;

// Neighbours of every point, itself first: kOfPlane indices each, as NeighbourIndex::Nearest.
struct Neighbourhoods {
  std::vector<int> nearest;

  int At(Eigen::Index point, int j) const {
    return nearest[static_cast<size_t>(point * kOfPlane + j)];
  }
};

struct OrientedNormals {
  Eigen::Matrix3Xd normals;   // (3 × m) of length 1
  Eigen::VectorXd roughness;  // root of the least over the middle variance of the neighbours: 0 of
                              // a plane; above 0.35 a second sheet, an edge or noise is among them
};

// Normals by principal components of each point's nearest 13, with signs carried along the minimum
// spanning tree of the graph of 8 neighbours, whose edges cost more the more normals turn and the
// rougher both ends are: the tree enters places where sheets meet last. Signs there, and between
// trees that hang together through them only, are those of chance. O(m log m). [Hoppe et al. 1992]
OrientedNormals OrientNormals(const Eigen::Matrix3Xd& points, const Neighbourhoods& around);

}  // namespace batten::internal
