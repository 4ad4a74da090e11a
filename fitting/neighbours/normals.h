// SPDX-License-Identifier: MIT
// Normals of a cloud from the planes through each point's neighbours, estimated with PCL.
#pragma once

#include <Eigen/Core>

#include "batten/fitting/neighbours.h"

namespace batten::internal {

// Estimates unit normals at the queries, without a consistent sign: the direction of least variance
// of the k nearest points, or a zero vector if that is undefined. Points are those the index was
// made of.
Eigen::Matrix3Xd EstimateNormals(const NeighbourIndex& index,
                                 const Eigen::Matrix3Xd& points,
                                 const Eigen::Matrix3Xd& queries,
                                 int k);

}  // namespace batten::internal
