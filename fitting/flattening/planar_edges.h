// SPDX-License-Identifier: MIT
// The ways between neighbouring nodes of a sheet as its tangent planes see them, and the maps that
// lay them out in the plane.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <vector>

#include "fitting/flattening/sheet_graph.h"

namespace batten::internal {

// An edge seen from both its ends: the way to the other one in the own tangent plane, as long as
// the arc between both normals.
struct PlanarEdge {
  int first, second;  // first < second
  double weight;      // of VoronoiEdgeWeights
  std::complex<double> from_first, from_second;
};

// In the order of VoronoiEdgeWeights.
std::vector<PlanarEdge> PlanarEdges(const SheetGraph& graph);

// The linear maps dz = a q + b conj(q) that serve the edges around each node best. The edges are
// referred to, not copied.
class LocalMaps {
 public:
  LocalMaps(Eigen::Index nodes, const std::vector<PlanarEdge>& edges);

  // `ways` of the edges in the plane, from first to second. Near the rotations where edges leave a
  // map open. O(edges).
  void Fit(const Eigen::VectorXcd& ways, const Eigen::VectorXcd& rotations);

  // The rotations of the maps; those given where a map has none.
  Eigen::VectorXcd Rotations(const Eigen::VectorXcd& otherwise) const;

  double Folded() const;  // share of the nodes with |a| ≤ |b|

  Eigen::VectorXcd a, b;

 private:
  const std::vector<PlanarEdge>& edges_;
  Eigen::VectorXd lengths_;
  Eigen::VectorXcd squares_;
};

// Root of Σ w |way − r q|² / Σ w |q|² over both ends of all edges.
double MisfitOf(const std::vector<PlanarEdge>& edges,
                const Eigen::VectorXcd& ways,
                const Eigen::VectorXcd& rotations);

}  // namespace batten::internal
