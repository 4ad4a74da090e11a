// SPDX-License-Identifier: MIT
#include "geometry/mesh/shell_tessellation.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>

#include "batten/geometry/bounding_box.h"
#include "geometry/mesh/border_shares.h"
#include "geometry/mesh/mesh_extraction.h"

namespace batten::internal {
namespace {

// Of the chord tolerance: what triangles take of it, how far edges may be from lines in space, and
// how far beside the curve a face may split them; its neighbour may on the other side.
constexpr double kOfTriangles = 0.75, kOfEdges = 0.375, kBesideEdges = 0.125;

// The vertices between two of a loop, in order.
void AppendCuts(const ConstrainedDelaunay& mesh, int from, int to, std::vector<int>& cuts) {
  const int vertex = mesh.CutOf(from, to);
  if (vertex < 0) return;
  AppendCuts(mesh, from, vertex, cuts);
  cuts.push_back(vertex);
  AppendCuts(mesh, vertex, to, cuts);
}

void Turn(TriangleMesh& mesh) {
  mesh.normals = -mesh.normals;
  mesh.triangles.row(1).swap(mesh.triangles.row(2));
  for (OtherSide& side : mesh.other_sides) side.normal = -side.normal;
  for (SideCorner& corner : mesh.side_corners) {
    if (corner.corner > 0) corner.corner = 3 - corner.corner;
  }
}

}  // namespace

ShellTessellation::ShellTessellation(const std::vector<NurbsSurface>& surfaces,
                                     const std::vector<FaceBorder>& borders,
                                     double tolerance,
                                     const TessellateOptions& options)
    : borders_(borders),
      tolerance_(tolerance),
      options_(options),
      face_options_(options),
      waiting_(surfaces.size(), 1),
      pieces_of_(surfaces.size()) {
  if (options.progress) {
    face_options_.progress = [this](double share) {
      const auto count = static_cast<double>(faces_.size());
      options_.progress(std::min((static_cast<double>(refined_) + share) / count, 1.0));
    };
  }
  for (const NurbsSurface& surface : surfaces) {
    faces_.push_back(std::make_unique<SurfaceTessellation>(
        surface, BoundingBox(surface).center(), kOfTriangles * tolerance, face_options_));
  }
}

ShellMesh ShellTessellation::Run() {
  CollectEdges();
  DivideEdges();
  LayFaces();
  for (Edge& edge : edges_) MakeNodes(edge);
  for (Edge& edge : edges_) Synchronise(edge);
  RefineFaces();
  while (SplitDoubledEdges()) RefineFaces();
  return Extracted();
}

void ShellTessellation::CollectEdges() {
  for (const FaceBorder& border : borders_) {
    for (const auto& loop : border.loops) {
      if (loop.empty()) throw std::invalid_argument("TessellateShell: borders: a loop is empty");
      for (const BorderPiece& piece : loop) {
        if (piece.edge >= static_cast<int>(edges_.size())) {
          edges_.resize(static_cast<std::size_t>(piece.edge) + 1);
        }
      }
    }
  }
  for (std::size_t face = 0; face < borders_.size(); ++face) {
    const auto& loops = borders_[face].loops;
    for (std::size_t loop = 0; loop < loops.size(); ++loop) {
      for (std::size_t piece = 0; piece < loops[loop].size(); ++piece) {
        const BorderPiece& one = loops[loop][piece];
        const std::size_t edge = one.edge < 0 ? edges_.size() : static_cast<std::size_t>(one.edge);
        if (one.edge < 0) edges_.emplace_back();
        pieces_of_[face].push_back({edge, edges_[edge].uses.size()});
        edges_[edge].uses.push_back({face, loop, piece, one.reversed});
      }
    }
  }
}

void ShellTessellation::DivideEdges() {
  for (Edge& edge : edges_) {
    for (const Use& use : edge.uses) {
      const NurbsCurve<2>& curve = borders_[use.face].loops[use.loop][use.piece].curve;
      for (const double share : BorderShares(
               curve, faces_[use.face]->mesh(), kOfEdges * tolerance_, kBesideEdges * tolerance_)) {
        edge.shares.push_back(use.reversed ? 1 - share : share);
      }
    }
    SortShares(edge.shares);
  }
}

void ShellTessellation::LayFaces() {
  for (std::size_t face = 0; face < faces_.size(); ++face) {
    if (borders_[face].loops.empty()) {
      faces_[face]->Lay();
    } else {
      LayFace(face);
    }
  }
}

// Each piece is laid but for its end, which is the beginning of the next one.
void ShellTessellation::LayFace(std::size_t face) {
  const auto& loops = borders_[face].loops;
  std::vector<std::vector<Eigen::Vector2d>> places(loops.size());
  std::vector<std::size_t> starts;  // of each piece, in the places of its loop
  for (const PieceOf& one : pieces_of_[face]) {
    const Use& use = edges_[one.edge].uses[one.use];
    const NurbsCurve<2>& curve = loops[use.loop][use.piece].curve;
    const std::vector<double>& shares = edges_[one.edge].shares;
    starts.push_back(places[use.loop].size());
    for (std::size_t k = 0; k + 1 < shares.size(); ++k) {
      const double share = use.reversed ? 1 - shares[shares.size() - 1 - k] : shares[k];
      places[use.loop].push_back(faces_[face]->mesh().Clamped(AtShare(curve, share)));
    }
  }
  const std::vector<std::vector<int>> chains = faces_[face]->LayAlong(places);
  for (std::size_t k = 0; k < starts.size(); ++k) {
    Edge& edge = edges_[pieces_of_[face][k].edge];
    Use& use = edge.uses[pieces_of_[face][k].use];
    const std::vector<int>& chain = chains[use.loop];
    for (std::size_t i = 0; i < edge.shares.size(); ++i) {
      use.vertices.push_back(chain[(starts[k] + i) % chain.size()]);
    }
    if (use.reversed) std::reverse(use.vertices.begin(), use.vertices.end());
  }
}

// The two sides of a seam that the surface closes over are joined already.
bool ShellTessellation::OnSeam(const Edge& edge) const {
  if (edge.uses.size() != 2 || edge.uses[0].face != edge.uses[1].face) return false;
  const DomainMesh& mesh = faces_[edge.uses[0].face]->mesh();
  const std::vector<int>& vertices = edge.uses[0].vertices;
  return std::all_of(vertices.begin(), vertices.end(), [&](int vertex) {
    return !mesh.domain().Mirrored(mesh.delaunay().points()[vertex]).empty();
  });
}

Eigen::Vector3d ShellTessellation::PointOf(const Use& use, std::size_t at) const {
  const DomainMesh& mesh = faces_[use.face]->mesh();
  return mesh.point(use.vertices[at]) + mesh.middle();
}

int ShellTessellation::NewNode(const Eigen::Vector3d& point) {
  nodes_.push_back(point);
  parents_.push_back(static_cast<int>(parents_.size()));
  return parents_.back();
}

void ShellTessellation::MakeNodes(Edge& edge) {
  edge.shared = edge.uses.size() > 1 && !OnSeam(edge);
  if (!edge.shared) return;
  for (std::size_t k = 0; k < edge.shares.size(); ++k) {
    edge.nodes.push_back(NewNode(PointOf(edge.uses[0], k)));
  }
}

// Gives every face of the edge what any of them has put between its nodes.
void ShellTessellation::Synchronise(Edge& edge) {
  if (!edge.shared) return;
  for (std::size_t k = edge.nodes.size() - 1; k > 0; --k) SynchroniseBetween(edge, k - 1);
}

void ShellTessellation::SynchroniseBetween(Edge& edge, std::size_t at) {
  // Every cut by its share of the way between the two nodes: as those of one face have it.
  struct Cut {
    double share;
    std::size_t use;
    int vertex;
  };
  std::vector<Cut> cuts;
  for (std::size_t k = 0; k < edge.uses.size(); ++k) {
    const Use& use = edge.uses[k];
    const DomainMesh& mesh = faces_[use.face]->mesh();
    std::vector<int> own;
    AppendCuts(mesh.delaunay(), use.vertices[at], use.vertices[at + 1], own);
    const Eigen::Vector3d start = mesh.point(use.vertices[at]);
    const Eigen::Vector3d way = mesh.point(use.vertices[at + 1]) - start;
    double last = 0;
    for (const int vertex : own) {
      last = std::max(last, (mesh.point(vertex) - start).dot(way) / way.squaredNorm());
      cuts.push_back({last, k, vertex});
    }
  }
  if (cuts.empty()) return;
  std::stable_sort(
      cuts.begin(), cuts.end(), [](const Cut& a, const Cut& b) { return a.share < b.share; });
  constexpr double kSame = 1e-6;
  std::size_t place = at;  // of the node before
  for (std::size_t k = 0; k < cuts.size();) {
    std::vector<int> vertices(edge.uses.size(), -1);
    const double share = cuts[k].share;
    const Use& maker = edge.uses[cuts[k].use];
    const DomainMesh& mesh = faces_[maker.face]->mesh();
    const Eigen::Vector3d point = mesh.point(cuts[k].vertex) + mesh.middle();
    for (; k < cuts.size() && cuts[k].share - share <= kSame && vertices[cuts[k].use] < 0; ++k) {
      vertices[cuts[k].use] = cuts[k].vertex;
    }
    edge.nodes.insert(edge.nodes.begin() + static_cast<std::ptrdiff_t>(place) + 1, NewNode(point));
    for (std::size_t u = 0; u < edge.uses.size(); ++u) {
      std::vector<int>& known = edge.uses[u].vertices;
      known.insert(known.begin() + static_cast<std::ptrdiff_t>(place) + 1, vertices[u]);
    }
    ++place;
  }
  SplitOthers(edge, at, place + 1);
}

// Puts vertices where a face has none between two nodes both have.
void ShellTessellation::SplitOthers(Edge& edge, std::size_t from, std::size_t to) {
  for (Use& use : edge.uses) {
    for (std::size_t k = from + 1; k < to; ++k) {
      if (use.vertices[k] >= 0) continue;
      std::size_t next = k;
      while (use.vertices[next] < 0) ++next;
      const int before = use.vertices[k - 1], after = use.vertices[next];
      use.vertices[k] = before == after ? before
                                        : faces_[use.face]->SplitNear(
                                              before, after, nodes_[std::size_t(edge.nodes[k])]);
      waiting_[use.face] = 1;
    }
  }
}

void ShellTessellation::RefineFaces() {
  refined_ = 0;
  for (bool any = true; any;) {
    any = false;
    for (std::size_t face = 0; face < faces_.size(); ++face) {
      if (!waiting_[face]) continue;
      any = true;
      waiting_[face] = 0;
      faces_[face]->Refine();
      refined_ = std::min(refined_ + 1, faces_.size());
      for (const PieceOf& one : pieces_of_[face]) Synchronise(edges_[one.edge]);
      CheckCount();
    }
  }
}

void ShellTessellation::CheckCount() const {
  std::size_t count = 0;
  for (const auto& face : faces_) count += face->mesh().delaunay().triangles().size();
  if (static_cast<Eigen::Index>(count) > options_.max_triangles) faces_[0]->Refuse();
}

int ShellTessellation::Find(int node) {
  while (parents_[node] != node) node = parents_[node] = parents_[parents_[node]];
  return node;
}

// Of every vertex of every face its node, −1: none.
std::vector<std::vector<int>> ShellTessellation::Joints() {
  std::vector<std::vector<int>> joints(faces_.size());
  std::vector<std::vector<int>> names(faces_.size());
  for (std::size_t face = 0; face < faces_.size(); ++face) {
    names[face] = faces_[face]->mesh().Names();
    joints[face].assign(names[face].size(), -1);
  }
  for (const Edge& edge : edges_) {
    if (!edge.shared) continue;
    for (const Use& use : edge.uses) {
      for (std::size_t k = 0; k < edge.nodes.size(); ++k) {
        int& joint = joints[use.face][names[use.face][use.vertices[k]]];
        const int node = Find(edge.nodes[k]), known = joint < 0 ? node : Find(joint);
        parents_[std::max(node, known)] = joint = std::min(node, known);
      }
    }
  }
  for (std::size_t face = 0; face < faces_.size(); ++face) {
    for (std::size_t k = 0; k < joints[face].size(); ++k) {
      const int joint = joints[face][names[face][k]];
      joints[face][k] = joint < 0 ? -1 : Find(joint);
    }
  }
  return joints;
}

// Edges of the mesh that are one by their ends, but inside faces: each gets a vertex of its own.
// Whether there were any.
bool ShellTessellation::SplitDoubledEdges() {
  struct Copy {
    std::size_t face;
    int from, to;
    bool inside;
  };
  // A joint, or a vertex of one face.
  using Name = std::pair<std::size_t, int>;
  const std::vector<std::vector<int>> joints = Joints();
  std::map<std::pair<Name, Name>, std::vector<Copy>> edges;
  for (std::size_t face = 0; face < faces_.size(); ++face) {
    const std::vector<int> names = faces_[face]->mesh().Names();
    const auto name = [&](int vertex) {
      const int joint = joints[face][vertex];
      return joint >= 0 ? Name{faces_.size(), joint} : Name{face, names[vertex]};
    };
    for (const ConstrainedDelaunay::Triangle& triangle :
         faces_[face]->mesh().delaunay().triangles()) {
      if (!triangle.inside) continue;
      const std::array<int, 3>& v = triangle.vertices;
      const std::array<Name, 3> own{name(v[0]), name(v[1]), name(v[2])};
      if (own[0] == own[1] || own[1] == own[2] || own[2] == own[0]) continue;
      for (int e = 0; e < 3; ++e) {
        const int a = (e + 1) % 3, b = (e + 2) % 3;
        if (joints[face][v[a]] < 0 && joints[face][v[b]] < 0) continue;
        edges[std::minmax(own[a], own[b])].push_back({face, v[a], v[b], !(triangle.odd >> e & 1)});
      }
    }
  }
  bool any = false;
  for (const auto& [ends, copies] : edges) {
    if (copies.size() <= 2) continue;
    for (const Copy& copy : copies) {
      if (!copy.inside || !faces_[copy.face]->Halve(copy.from, copy.to)) continue;
      waiting_[copy.face] = 1;
      any = true;
    }
  }
  return any;
}

ShellMesh ShellTessellation::Extracted() {
  ShellMesh shell;
  const std::vector<std::vector<int>> joints = Joints();
  std::map<int, int> numbers;  // of the nodes in use, in order
  for (std::size_t face = 0; face < faces_.size(); ++face) {
    const DomainMesh& mesh = faces_[face]->mesh();
    std::vector<int> names = mesh.Names();
    std::map<int, int> first;  // vertex of each node
    for (std::size_t k = 0; k < names.size(); ++k) {
      const int joint = joints[face][k];
      if (joint >= 0) names[k] = first.emplace(joint, names[k]).first->second;
    }
    ExtractedMesh extracted = ExtractMesh(mesh, names);
    std::vector<int>& of_face = shell.joints.emplace_back();
    for (std::size_t k = 0; k < extracted.origins.size(); ++k) {
      const int joint = joints[face][extracted.origins[k]];
      if (joint < 0) {
        of_face.push_back(-1);
        continue;
      }
      of_face.push_back(numbers.emplace(joint, static_cast<int>(numbers.size())).first->second);
      auto vertex = extracted.mesh.vertices.col(static_cast<Eigen::Index>(k));
      shell.gap = std::max(shell.gap, (vertex - nodes_[joint]).norm());
      vertex = nodes_[joint];
    }
    if (borders_[face].reversed) Turn(extracted.mesh);
    shell.faces.push_back(std::move(extracted.mesh));
  }
  return shell;
}

}  // namespace batten::internal
