// SPDX-License-Identifier: MIT
// Faces tessellated together, with the same vertices along the edges they share. Internal to
// geometry.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <memory>
#include <vector>

#include "batten/geometry/nurbs_surface.h"
#include "batten/geometry/triangle_mesh.h"
#include "geometry/mesh/surface_tessellation.h"

namespace batten::internal {

class ShellTessellation {
 public:
  // Keeps references to the borders and options.
  ShellTessellation(const std::vector<NurbsSurface>& surfaces,
                    const std::vector<FaceBorder>& borders,
                    double tolerance,
                    const TessellateOptions& options);

  ShellMesh Run();

 private:
  // A piece of the border of a face.
  struct Use {
    std::size_t face, loop, piece;
    bool reversed;
    std::vector<int> vertices = {};  // of the face, in the edge's direction, one for each node
  };
  struct Edge {
    std::vector<Use> uses;
    std::vector<double> shares = {0, 1};  // where it is divided to begin with
    bool shared = false;
    std::vector<int> nodes = {};  // points in space along it, if it is shared
  };

  // A piece of the border of a face, as a use of an edge.
  struct PieceOf {
    std::size_t edge, use;
  };

  void CollectEdges();
  void DivideEdges();
  void LayFaces();
  void LayFace(std::size_t face);
  int NewNode(const Eigen::Vector3d& point);
  void MakeNodes(Edge& edge);
  bool OnSeam(const Edge& edge) const;
  Eigen::Vector3d PointOf(const Use& use, std::size_t at) const;
  void Synchronise(Edge& edge);
  void SynchroniseBetween(Edge& edge, std::size_t at);
  void SplitOthers(Edge& edge, std::size_t from, std::size_t to);
  void RefineFaces();
  void CheckCount() const;
  bool SplitDoubledEdges();
  std::vector<std::vector<int>> Joints();
  int Find(int node);
  ShellMesh Extracted();

  const std::vector<FaceBorder>& borders_;
  double tolerance_;
  const TessellateOptions& options_;
  TessellateOptions face_options_;
  std::vector<std::unique_ptr<SurfaceTessellation>> faces_;
  std::vector<char> waiting_;                    // faces to be refined
  std::vector<Edge> edges_;                      // those with numbers, then pieces without one
  std::vector<std::vector<PieceOf>> pieces_of_;  // of each face, in the order of its loops
  std::vector<Eigen::Vector3d> nodes_;
  std::vector<int> parents_;  // of nodes: those that are one point lead to the first of them
  std::size_t refined_ = 0;
};

}  // namespace batten::internal
