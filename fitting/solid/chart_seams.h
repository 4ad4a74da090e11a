// SPDX-License-Identifier: MIT
// Where charts of a surface's triangles do not go on into one another.
#pragma once

#include <complex>
#include <vector>

#include "fitting/solid/gaussian_lattice.h"
#include "fitting/solid/triangle_topology.h"

namespace batten::internal {

// Crosses turned by right angles until they go on across all edges but the seams: lines between
// singular vertices, and about handles. Along a line the chart on the other side is turned by the
// same right angles and moved by the same unknown shift.
class ChartSeams {
 public:
  ChartSeams(const TriangleTopology& topology,
             const std::vector<std::complex<double>>& planar_edges,
             const std::vector<double>& crosses,
             const std::vector<int>& held);

  const std::vector<std::complex<double>>& directions() const { return directions_; }
  int Turn(int h) const { return turn_[std::size_t(h)]; }  // quarter turns across a half-edge
  int lines() const { return lines_; }
  bool IsSeam(int h) const { return line_[std::size_t(h)] >= 0; }
  // The shift across a half-edge is factor times that of the line.
  int Line(int h) const { return line_[std::size_t(h)]; }
  Gaussian Factor(int h) const {
    return forward_[std::size_t(h)] ? Gaussian(1) : -PowerOfI(Turn(h));
  }
  // Vertices whose place has to be an integer: about which charts turn, those held, and one of
  // every component that has none of these.
  const std::vector<int>& anchors() const { return anchors_; }
  const std::vector<int>& pinned() const { return pinned_; }  // of anchors: one of each component

 private:
  void Comb(const std::vector<std::complex<double>>& planar_edges,
            const std::vector<double>& crosses);
  void FindAnchors(const std::vector<int>& held);
  void PruneSeams();
  void NumberLines();
  void FollowLine(int first, std::vector<char>& ends);
  int TurnAbout(int vertex) const;

  const TriangleTopology& topology_;
  std::vector<std::complex<double>> directions_;  // unit, in the plane of each triangle
  std::vector<int> turn_, line_;
  std::vector<char> forward_;
  std::vector<int> component_, anchors_, pinned_;
  int lines_ = 0;
};

}  // namespace batten::internal
