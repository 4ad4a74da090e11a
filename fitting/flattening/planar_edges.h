// SPDX-License-Identifier: MIT
// Edges of a sheet's graph in the tangent planes of their ends, and the local linear maps that
// flatten them.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <vector>

#include "fitting/flattening/sheet_graph.h"

namespace batten::internal {

// An edge as a vector in the tangent plane of each of its ends, as long as the arc between both
// normals.
struct PlanarEdge {
  int first, second;  // first < second
  double weight;      // of VoronoiEdgeWeights
  std::complex<double> from_first, from_second;
};

// Returns the edges of the graph, in the order of VoronoiEdgeWeights.
std::vector<PlanarEdge> PlanarEdges(const SheetGraph& graph);

// Least-squares linear maps dz = a q + b conj(q) of the edges around each node. The edges are
// referred to, not copied.
class LocalMaps {
 public:
  LocalMaps(Eigen::Index nodes, const std::vector<PlanarEdge>& edges);

  // Fits the maps to `ways`, the edges in the plane from first to second. A map that its edges
  // leave undetermined is taken near the rotation. O(edges).
  void Fit(const Eigen::VectorXcd& ways, const Eigen::VectorXcd& rotations);

  // Returns the rotations of the maps; those given if a map has none.
  Eigen::VectorXcd Rotations(const Eigen::VectorXcd& otherwise) const;

  double Folded() const;  // share of the nodes with |a| ≤ |b|

  Eigen::VectorXcd a, b;

 private:
  const std::vector<PlanarEdge>& edges_;
  Eigen::VectorXd lengths_;
  Eigen::VectorXcd squares_;
};

// Returns the relative misfit, the root of Σ w |way − r q|² / Σ w |q|² over both ends of all edges.
double MisfitOf(const std::vector<PlanarEdge>& edges,
                const Eigen::VectorXcd& ways,
                const Eigen::VectorXcd& rotations);

}  // namespace batten::internal
