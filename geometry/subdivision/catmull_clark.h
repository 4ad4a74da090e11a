// SPDX-License-Identifier: MIT
// One step of Catmull-Clark subdivision.
#pragma once

#include <Eigen/SparseCore>

#include "geometry/subdivision/quad_topology.h"

namespace batten::internal {

using StencilMatrix = Eigen::SparseMatrix<double, Eigen::RowMajor>;

// The finer mesh and its vertices as combinations of the coarser one's: points_fine =
// points_coarse · stencilsᵀ. Vertices come first, then a point for every edge, then one for every
// face. Face f becomes the faces 4f + k: the corner k of f, the point of its half-edge k, that of
// the face, that of its half-edge k − 1. So corner 0 of a finer face is a vertex of the coarser
// mesh, and only there can it have other than four edges. Creases are halved, corners stay.
// [Catmull & Clark 1978; creases: Hoppe et al. 1994, DeRose, Kass & Truong 1998]
struct SubdividedMesh {
  QuadTopology topology;
  StencilMatrix stencils;
};
SubdividedMesh Subdivided(const QuadTopology& coarse);

// Control points (3 × n) times the stencils.
Eigen::Matrix3Xd Combined(const StencilMatrix& stencils, const Eigen::Matrix3Xd& points);

}  // namespace batten::internal
