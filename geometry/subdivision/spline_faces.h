// SPDX-License-Identifier: MIT
// A Catmull-Clark surface as bicubic B-spline faces that share their edges.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "batten/geometry/solid_model.h"
#include "geometry/subdivision/limit_surface.h"
#include "geometry/subdivision/quad_topology.h"

namespace batten::internal {

// A block of faces of a mesh, `across` × `along`: the face of half-edge `first` is the lowest one,
// u runs along that half-edge over `across` faces, v over `along`.
struct QuadBlock {
  int first = 0;
  int across = 1, along = 1;
};

// Blocks that cover a mesh, as few as creases and lines traced from vertices whose fans are not
// plain leave: each line ends where it meets another or a crease. Lines go on by turns, one face
// each. Smooth parts without such vertices or corners get crossing lines. [motorcycle graph:
// Eppstein, Goodrich, Kim & Tamstorf 2008]
std::vector<QuadBlock> MotorcycleBlocks(const QuadTopology& mesh);

// One block for each face.
std::vector<QuadBlock> SingleBlocks(const QuadTopology& mesh);

// Where each face of a mesh lies in the blocks: that of cell (column, row), u along `half_edge`.
struct BlockPlace {
  int block = -1, column = 0, row = 0;
  int half_edge = 0;
};
std::vector<BlockPlace> PlacesInBlocks(const QuadTopology& mesh,
                                       const std::vector<QuadBlock>& blocks);

// The same blocks of the mesh after a step of Subdivided.
std::vector<QuadBlock> SubdividedBlocks(std::vector<QuadBlock> blocks);

// The parameters of a place of the limit surface on the face of its block, as SplineSolid makes it.
Eigen::Vector2d ParametersInBlock(const BlockPlace& face,
                                  const LimitPlace& place,
                                  int refinements = 2);

// The limit surface over the blocks, each one bicubic B-spline with a knot at every cell of the
// mesh refined so many times: exact, but for the quarter of a cell beside a vertex whose fan is not
// plain, where SmoothCorner makes tangent planes continuous. Blocks have at least four cells along
// each side. Parameters count cells. Sides of blocks are cut into edges where
// blocks beside them end; those on creases are sharp. Control points are columns, one for each
// vertex; those whose fans are not plain must be corners of blocks only.
SolidModel SplineSolid(const QuadTopology& mesh,
                       const Eigen::Matrix3Xd& control_points,
                       const std::vector<QuadBlock>& blocks,
                       int refinements = 2);

}  // namespace batten::internal
