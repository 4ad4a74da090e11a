// SPDX-License-Identifier: MIT
// Who is next to whom in a closed mesh of quadrilaterals.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace batten::internal {

// Half-edges 4f + k run along face f from its corner k to its corner k + 1, the face on their left.
// Around a grid cell whose half-edge runs along u, Right, Up, Left and Down give the half-edge of
// the neighbouring cell that runs the same way, where the vertices passed have four edges.
class QuadTopology {
 public:
  // Throws std::invalid_argument as CheckQuadMesh does, volumes aside.
  QuadTopology(Eigen::Matrix4Xi faces, int vertices);

  int faces() const { return static_cast<int>(faces_.cols()); }
  int vertices() const { return static_cast<int>(outgoing_.size()); }
  int edges() const { return 2 * faces(); }
  int half_edges() const { return 4 * faces(); }
  const Eigen::Matrix4Xi& corners() const { return faces_; }

  static int Next(int h) { return (h & ~3) | ((h + 1) & 3); }
  static int Previous(int h) { return (h & ~3) | ((h + 3) & 3); }
  static int Across(int h) { return h ^ 2; }  // the opposite side of the same face
  int Twin(int h) const { return twin_[h]; }
  int Origin(int h) const { return faces_(h & 3, h >> 2); }
  int Edge(int h) const { return edge_[h]; }  // 0 … edges() − 1, the same for both halves
  // The outgoing half-edge of the same vertex that follows counter-clockwise.
  int Turned(int h) const { return twin_[Previous(h)]; }

  int Right(int h) const { return Next(twin_[Next(h)]); }
  int Up(int h) const { return twin_[Across(h)]; }
  int Left(int h) const { return Previous(twin_[Previous(h)]); }
  int Down(int h) const { return Across(twin_[h]); }

  int Valence(int vertex) const { return valence_[vertex]; }
  int Outgoing(int vertex) const { return outgoing_[vertex]; }  // one of its half-edges

  // The component of each face, from 0 in the order of the faces.
  std::vector<int> Components() const;

 private:
  void FindTwins();
  void FindFans();

  Eigen::Matrix4Xi faces_;
  std::vector<int> twin_, edge_, outgoing_, valence_;
};

}  // namespace batten::internal
