// SPDX-License-Identifier: MIT
// As-rigid-as-possible (ARAP) flattening of the nodes of a bent sheet, or of a
// tube into a periodic strip.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "fitting/flattening/planar_edges.h"
#include "fitting/flattening/sheet_graph.h"

namespace batten::internal {

struct Flattening {
  Eigen::VectorXcd places;         // of the nodes in the plane, lengths as along the sheet
  Eigen::VectorXcd conformal;      // the map around a node: dz = a q + b conj(q), q = x + iy in its
  Eigen::VectorXcd anticonformal;  // tangent plane; a and b
  Eigen::Matrix3Xcd bend;          // and c q² + d q conj(q) + e conj(q)²; no columns: none
  double period = 0;  // of a tube: places this far apart along the real axis are the same
  double distortion =
      0;  // root of Σ w |change of an edge|² / Σ w |edge|²: 0 for developable sheets
  double folded = 0;  // share of nodes with |a| ≤ |b|: the map is turned over there
};

// Flattens a sheet: minimises Σ w |z_j − z_i − r_i q_ij|² over places z and rotations r, |r_i| = 1,
// with w the weights of VoronoiEdgeWeights and q_ij the edge in node i's tangent plane, as long as
// the arc between both normals. The initial rotations agree best along the edges: they are the
// eigenvector of a Hermitian matrix to its least eigenvalue, by inverse iteration. Each round then
// solves for the places, by one factorised Laplacian, and takes the rotations of the best local
// linear maps: with irregular edges, least-squares rotations would be biased by the map's shear
// where lengths must change. [Singer 2011 for the first rotations; Sorkine & Alexa 2007, Liu et al.
// 2008 for the rounds] The graph is connected and has an edge. O(n^1.5) and rounds of O(n log n).
Flattening FlattenArap(const SheetGraph& graph);

// Flattens a tube as FlattenArap does a sheet, over periodic places: minimises
// Σ w |z_j + c_ij P − z_i − r_i q_ij|² over places, rotations and the period P, c_ij the crossings
// of the edges. The initial rotations turn the gradient of the harmonic angle round the tube to the
// real axis: they close round it whatever the tube's curvature; a few rounds then even out the
// effect of holes. The result is rotated so that P is real. Where lengths round the tube differ,
// the differences are distributed over one period. The crossings are those of a loop that is no sum
// of triangles. O(n^1.5) and rounds of O(n log n).
Flattening FlattenTubeArap(const SheetGraph& graph,
                           const std::vector<PlanarEdge>& edges,
                           const std::vector<int>& crossings);

}  // namespace batten::internal
