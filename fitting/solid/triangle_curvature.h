// SPDX-License-Identifier: MIT
// How a surface of triangles bends.
#pragma once

#include <Eigen/Core>

#include "fitting/solid/triangle_topology.h"

namespace batten::internal {

// Of length 1, in the mean of the triangles about each vertex, larger ones counting more.
Eigen::Matrix3Xd VertexNormals(const TriangleSurface& surface);

inline constexpr int kCurvatureRounds = 4;  // that make means of noise

// Of every triangle, in the mean of those about it.
struct TriangleCurvature {
  // Half the difference of the principal curvatures times the square of the direction of the
  // greater, in the plane of the triangle as PlanarEdges has it.
  Eigen::VectorXcd difference;
  Eigen::VectorXd mean;  // of the two
};

// From the normals of vertices. [Rusinkiewicz 2004] The mean is over `rounds` triangles in every
// direction.
TriangleCurvature CurvatureOf(const TriangleSurface& surface,
                              const TriangleTopology& topology,
                              int rounds);

// The square of a direction from a half-edge's triangle to its twin's, as a factor.
std::vector<std::complex<double>> SquaresAcross(const TriangleTopology& topology,
                                                const std::vector<std::complex<double>>& planar);

// How long faces of a layout may be in every triangle, relative to one another: as the root of the
// radius of curvature, from 0.5 to 1.6, without jumps. `face_length`: in the mean.
Eigen::VectorXd FaceSizes(const TriangleSurface& surface,
                          const TriangleTopology& topology,
                          double face_length);

}  // namespace batten::internal
