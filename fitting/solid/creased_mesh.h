// SPDX-License-Identifier: MIT
// Triangles with creases that are changed edge by edge.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "batten/geometry/triangle_surface.h"
#include "fitting/solid/surface_creases.h"

namespace batten::internal {

struct CreasedSurface {
  TriangleSurface surface;
  SurfaceCreases creases;
};

// Numbers of vertices and triangles stay; those that go leave theirs empty. Creases stay chains of
// edges.
class CreasedMesh {
 public:
  using Triangle = std::array<int, 3>;

  CreasedMesh(const TriangleSurface& surface, const SurfaceCreases& creases);

  const std::vector<Eigen::Vector3d>& places() const { return places_; }
  const Eigen::Vector3d& At(int v) const { return places_[std::size_t(v)]; }
  const Triangle& TriangleAt(int t) const { return triangles_[std::size_t(t)]; }
  // The triangles about a vertex; none: it is gone.
  const std::vector<int>& Around(int v) const { return around_[std::size_t(v)]; }
  // The other ends of crease edges.
  const std::vector<int>& Along(int v) const { return along_[std::size_t(v)]; }

  // As long as twice the area.
  Eigen::Vector3d NormalOf(const Triangle& t) const;

  static int After(const Triangle& t, int v) { return v == t[0] ? t[1] : v == t[1] ? t[2] : t[0]; }

  // The triangle to the left of the edge from a to b, and its third corner; −1: none.
  std::pair<int, int> LeftOf(int a, int b) const;

  std::vector<int> Neighbours(int v) const;

  // The lower end first.
  std::vector<std::pair<int, int>> Edges() const;

  bool OnCrease(int a, int b) const {
    return std::find(Along(a).begin(), Along(a).end(), b) != Along(a).end();
  }
  // How much keeps a vertex where it is: nothing, a crease, a corner.
  int Held(int v) const { return corner_[std::size_t(v)] ? 2 : Along(v).empty() ? 0 : 1; }

  // The edge has triangles on both sides: it gets a vertex in its middle; it goes with its end a,
  // and b comes to the place; it crosses to their third corners.
  void Split(int a, int b);
  void Collapse(int a, int b, const Eigen::Vector3d& place);
  void Turn(int a, int b);

  void MoveTo(std::vector<Eigen::Vector3d> places) { places_ = std::move(places); }

  CreasedSurface Surface() const;

 private:
  void Add(const Triangle& triangle);
  void Remove(int t);
  void Join(int a, int b);
  void Part(int a, int b);

  std::vector<Eigen::Vector3d> places_;
  std::vector<Triangle> triangles_;
  std::vector<std::vector<int>> around_, along_;
  std::vector<char> corner_;
};

}  // namespace batten::internal
