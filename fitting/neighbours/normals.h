// SPDX-License-Identifier: MIT
// Normals of a cloud from the planes through each point's neighbours, by PCL.
#pragma once

#include <Eigen/Core>

#include "batten/fitting/neighbours.h"

namespace batten::internal {

// Unit normals at the queries, without a consistent sign: the direction of least variance of the k
// nearest points; a zero vector where the neighbours leave it undefined. Points are those the index
// was made of.
Eigen::Matrix3Xd EstimateNormals(const NeighbourIndex& index,
                                 const Eigen::Matrix3Xd& points,
                                 const Eigen::Matrix3Xd& queries,
                                 int k);

}  // namespace batten::internal
