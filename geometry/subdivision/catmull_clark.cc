// SPDX-License-Identifier: MIT
#include "geometry/subdivision/catmull_clark.h"

#include <utility>
#include <vector>

namespace batten::internal {
namespace {

using Entries = std::vector<Eigen::Triplet<double>>;

void AddFacePoint(const QuadTopology& mesh, int face, int row, double factor, Entries& entries) {
  for (int k = 0; k < 4; ++k) entries.emplace_back(row, mesh.corners()(k, face), factor / 4);
}

// Where creases meet the vertex stays; else they are a uniform cubic spline.
void AddCreaseVertex(const QuadTopology& mesh, int v, Entries& entries) {
  const bool corner = mesh.IsCorner(v);
  entries.emplace_back(v, v, corner ? 1.0 : 0.75);
  if (corner) return;
  int h = mesh.Outgoing(v);
  for (int k = 0; k < mesh.Valence(v); ++k, h = mesh.Turned(h)) {
    if (mesh.IsCrease(h)) entries.emplace_back(v, mesh.Origin(QuadTopology::Next(h)), 0.125);
  }
}

Entries StencilsOf(const QuadTopology& mesh) {
  Entries entries;
  const int vertices = mesh.vertices(), edges = mesh.edges();
  for (int v = 0; v < vertices; ++v) {
    if (mesh.Creases(v) > 0) {
      AddCreaseVertex(mesh, v, entries);
      continue;
    }
    const int n = mesh.Valence(v);
    const double share = 1.0 / (double(n) * n);
    entries.emplace_back(v, v, (n - 2.0) / n);
    int h = mesh.Outgoing(v);
    for (int k = 0; k < n; ++k, h = mesh.Turned(h)) {
      entries.emplace_back(v, mesh.Origin(QuadTopology::Next(h)), share);
      AddFacePoint(mesh, h >> 2, v, share, entries);
    }
  }
  for (int h = 0; h < mesh.half_edges(); ++h) {
    const int row = vertices + mesh.Edge(h);
    if (mesh.IsCrease(h)) {
      entries.emplace_back(row, mesh.Origin(h), 0.5);
      continue;
    }
    // Each half brings one of the edge's ends and one of its faces.
    entries.emplace_back(row, mesh.Origin(h), 0.25);
    AddFacePoint(mesh, h >> 2, row, 0.25, entries);
  }
  for (int f = 0; f < mesh.faces(); ++f) {
    AddFacePoint(mesh, f, vertices + edges + f, 1.0, entries);
  }
  return entries;
}

}  // namespace

SubdividedMesh Subdivided(const QuadTopology& coarse) {
  const int vertices = coarse.vertices(), edges = coarse.edges(), faces = coarse.faces();
  Eigen::Matrix4Xi finer(4, 4 * faces);
  std::vector<char> creases(4 * coarse.half_edges(), 0), corners = coarse.corner_marks();
  corners.resize(vertices + edges + faces, 0);
  for (int h = 0; h < coarse.half_edges(); ++h) {
    // Its first half is a side of the finer face at its origin, the other one of that at its end.
    if (coarse.IsCrease(h)) creases[4 * h] = creases[4 * QuadTopology::Next(h) + 3] = 1;
    finer.col(h) << coarse.Origin(h), vertices + coarse.Edge(h), vertices + edges + (h >> 2),
        vertices + coarse.Edge(QuadTopology::Previous(h));
  }
  const Entries entries = StencilsOf(coarse);
  StencilMatrix stencils(vertices + edges + faces, vertices);
  stencils.setFromTriplets(entries.begin(), entries.end());
  return {QuadTopology(std::move(finer), std::move(creases), std::move(corners)),
          std::move(stencils)};
}

Eigen::Matrix3Xd Combined(const StencilMatrix& stencils, const Eigen::Matrix3Xd& points) {
  return (stencils * points.transpose()).transpose();
}

}  // namespace batten::internal
