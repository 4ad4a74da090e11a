// SPDX-License-Identifier: MIT
// Layouts of quadrilaterals made more regular.
#pragma once

#include <Eigen/Core>
#include <array>
#include <utility>
#include <vector>

#include "batten/geometry/quad_mesh.h"
#include "batten/geometry/triangle_surface.h"
#include "fitting/solid/surface_projector.h"

namespace batten::internal {

using Quad = std::array<int, 4>;

// Of the way to the middle that a vertex is moved at once, and the squareness from which on faces
// may become less even by that.
inline constexpr double kShareOfWay = 0.6, kFairSquareness = 0.5;

// How far the angles of a quadrilateral are from right ones: 1 for a square, 0 and less where one
// is flat or folded over.
double Squareness(const Eigen::Matrix3Xd& points, const Quad& quad);

// A mesh of quadrilaterals whose edges turn and whose faces collapse until fewer vertices have
// other than four. Creases and their vertices stay. [Docampo-Sánchez & Haimes 2019]
class QuadImprover {
 public:
  QuadImprover(const QuadMesh& mesh, const SurfaceProjector& projector);

  // Moves vertices to the middle of their faces', on the surface.
  void Smooth(int rounds);

  // Of the worst face.
  double LeastSquareness() const;

  void Improve();

  QuadMesh Mesh() const;

 private:
  int Valence(int v) const { return int(around_[std::size_t(v)].size()); }
  // How bad a number of edges is: three and five are the least that curvature asks for.
  static int Off(int valence);
  void Remove(int q);
  void Put(int q, const Quad& quad);
  // The face to the left of the edge from a to b, its corners from a on; −1: none.
  std::pair<int, Quad> LeftOf(int a, int b) const;
  // Whether a new face may stand: four corners, no edge that is there already in its direction.
  bool Allowed(const Quad& quad) const;
  static bool Even(const Eigen::Matrix3Xd& points, const Quad& quad);
  bool RemoveDoublets();
  // Joins opposite corners of a face where that helps.
  bool CollapseFaces();
  bool Collapse(int q, int a, int b, int c, int d);
  bool TurnEdges();
  // The diagonal of the hexagon of two faces moves on by one corner, to either side.
  bool TurnEdge(int a, int b);
  void Smooth();
  double LeastSquarenessAbout(int v) const;

  bool Held(int v) const { return held_[std::size_t(v)] != 0; }

  const SurfaceProjector& projector_;
  Eigen::Matrix3Xd points_;
  Eigen::Matrix2Xi creases_;
  std::vector<char> held_;  // vertices of creases
  std::vector<Quad> quads_;
  std::vector<std::vector<int>> around_;
};

// V − E + F of closed surfaces.
int EulerOf(const QuadMesh& mesh);
int EulerOf(const TriangleSurface& surface);

}  // namespace batten::internal
