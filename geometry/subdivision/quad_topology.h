// SPDX-License-Identifier: MIT
// Who is next to whom in a closed mesh of quadrilaterals.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "batten/geometry/quad_mesh.h"

namespace batten::internal {

// The faces between two creases at a vertex, or all where it has none: a surface is smooth there.
struct QuadFan {
  int first = 0;  // its outgoing half-edge that is clockwise of all others; any where it is closed
  int sectors = 0;
  bool open = false;    // between creases, else all round
  bool corner = false;  // open, and the curve of the creases ends or turns at the vertex

  // Whether the surface is a bicubic spline there: four faces, two at a crease, one at a corner.
  bool plain() const { return sectors == (!open ? 4 : corner ? 1 : 2); }
};

// Half-edges 4f + k run along face f from its corner k to its corner k + 1, the face on their left.
// Around a grid cell whose half-edge runs along u, Right, Up, Left and Down give the half-edge of
// the neighbouring cell that runs the same way, where the fans passed are plain; −1: over a crease.
class QuadTopology {
 public:
  // Throws std::invalid_argument as CheckQuadMesh does, volumes aside.
  QuadTopology(Eigen::Matrix4Xi faces, int vertices);
  explicit QuadTopology(const QuadMesh& mesh);
  // The creases by half-edge, the corners by vertex.
  QuadTopology(Eigen::Matrix4Xi faces, std::vector<char> creases, std::vector<char> corners);

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

  bool IsCrease(int h) const { return crease_[h]; }
  int Creases(int vertex) const { return creases_[vertex]; }  // that end there
  // Whether the curve of its creases ends or turns at a vertex.
  bool IsCorner(int vertex) const {
    return corner_[vertex] || creases_[vertex] > 2 || creases_[vertex] == 1;
  }
  const std::vector<char>& corner_marks() const { return corner_; }

  int Right(int h) const { return IsCrease(Next(h)) ? -1 : Next(twin_[Next(h)]); }
  int Up(int h) const { return IsCrease(Across(h)) ? -1 : twin_[Across(h)]; }
  int Left(int h) const { return IsCrease(Previous(h)) ? -1 : Previous(twin_[Previous(h)]); }
  int Down(int h) const { return IsCrease(h) ? -1 : Across(twin_[h]); }

  int Valence(int vertex) const { return valence_[vertex]; }
  int Outgoing(int vertex) const { return outgoing_[vertex]; }  // one of its half-edges
  // Of the face to the left of an outgoing half-edge. O(valence).
  QuadFan FanOf(int h) const;

  // The component of each face, from 0 in the order of the faces.
  std::vector<int> Components() const { return Parts(false); }
  // The same of the smooth parts between creases.
  std::vector<int> SmoothParts() const { return Parts(true); }

 private:
  void CheckFaces(int vertices) const;
  void FindTwins();
  void FindFans();
  void MarkCrease(int a, int b);
  void CountCreases();
  std::vector<int> Parts(bool smooth) const;

  Eigen::Matrix4Xi faces_;
  std::vector<int> twin_, edge_, outgoing_, valence_, creases_;
  std::vector<char> crease_, corner_;  // by half-edge, by vertex
};

}  // namespace batten::internal
