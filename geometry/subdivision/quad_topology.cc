// SPDX-License-Identifier: MIT
#include "geometry/subdivision/quad_topology.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cstdint>
#include <string>
#include <unordered_map>
#include <utility>

#include "batten/geometry/quad_mesh.h"
#include "geometry/numeric/reject.h"

namespace batten {
namespace internal {
namespace {

// Names count from 1, as OBJ files do.
std::string VertexName(int v) { return "vertex " + std::to_string(v + 1); }
std::string FaceName(int h) { return "face " + std::to_string((h >> 2) + 1); }

[[noreturn]] void Refuse(const std::string& reason) { Reject("quad mesh", reason); }

}  // namespace

QuadTopology::QuadTopology(Eigen::Matrix4Xi faces, int vertices)
    : QuadTopology(QuadMesh{Eigen::Matrix3Xd(3, vertices), std::move(faces)}) {}

QuadTopology::QuadTopology(const QuadMesh& mesh)
    : faces_(mesh.faces),
      outgoing_(mesh.vertices.cols(), -1),
      valence_(mesh.vertices.cols(), 0),
      crease_(4 * mesh.faces.cols(), 0),
      corner_(mesh.vertices.cols(), 0) {
  CheckFaces(static_cast<int>(mesh.vertices.cols()));
  FindTwins();
  FindFans();
  for (const int v : mesh.corners) {
    if (v < 0 || v >= vertices()) Refuse("a corner is a vertex that is not there");
    corner_[v] = 1;
  }
  for (const auto crease : mesh.creases.colwise()) MarkCrease(crease[0], crease[1]);
  CountCreases();
}

QuadTopology::QuadTopology(Eigen::Matrix4Xi faces,
                           std::vector<char> creases,
                           std::vector<char> corners)
    : faces_(std::move(faces)),
      outgoing_(corners.size(), -1),
      valence_(corners.size(), 0),
      crease_(std::move(creases)),
      corner_(std::move(corners)) {
  CheckFaces(vertices());
  FindTwins();
  FindFans();
  CountCreases();
}

void QuadTopology::MarkCrease(int a, int b) {
  if (std::min(a, b) < 0 || std::max(a, b) >= vertices()) {
    Refuse("a crease ends at a vertex that is not there");
  }
  int h = outgoing_[a];
  for (int turn = 0; turn < valence_[a]; ++turn, h = Turned(h)) {
    if (Origin(Next(h)) != b) continue;
    crease_[h] = crease_[twin_[h]] = 1;
    return;
  }
  Refuse("the crease from " + VertexName(a) + " to " + VertexName(b) + " is no edge");
}

void QuadTopology::CheckFaces(int vertices) const {
  if (faces_.cols() == 0) Refuse("there are no faces");
  for (int f = 0; f < faces_.cols(); ++f) {
    const auto face = faces_.col(f);
    if (face.minCoeff() < 0 || face.maxCoeff() >= vertices) {
      Refuse(FaceName(4 * f) + " names a vertex that is not there");
    }
    for (int k = 0; k < 4; ++k) {
      for (int m = 0; m < k; ++m) {
        if (face[k] == face[m]) Refuse(FaceName(4 * f) + " has " + VertexName(face[k]) + " twice");
      }
    }
  }
}

void QuadTopology::CountCreases() {
  creases_.assign(vertices(), 0);
  for (int h = 0; h < half_edges(); ++h) creases_[Origin(h)] += IsCrease(h);
}

QuadFan QuadTopology::FanOf(int h) const {
  const int vertex = Origin(h);
  if (creases_[vertex] == 0) return {outgoing_[vertex], valence_[vertex], false, false};
  while (!IsCrease(h)) h = Next(twin_[h]);
  QuadFan fan{h, 1, true, IsCorner(vertex)};
  for (; !IsCrease(Previous(h)); h = Turned(h)) ++fan.sectors;
  return fan;
}

void QuadTopology::FindTwins() {
  const auto key = [](int a, int b) { return std::int64_t{a} << 32 | std::uint32_t(b); };
  std::unordered_map<std::int64_t, int> directed;
  directed.reserve(half_edges());
  const auto name = [&](int h) {
    return "the edge from " + VertexName(Origin(h)) + " to " + VertexName(Origin(Next(h)));
  };
  for (int h = 0; h < half_edges(); ++h) {
    const auto [found, fresh] = directed.try_emplace(key(Origin(h), Origin(Next(h))), h);
    if (!fresh) {
      Refuse(name(h) + " is run along in the same direction by " + FaceName(found->second) +
             " and " + FaceName(h) +
             ": either faces are turned differently, or more than two meet there");
    }
  }
  twin_.assign(half_edges(), -1);
  edge_.assign(half_edges(), -1);
  int edges = 0;
  for (int h = 0; h < half_edges(); ++h) {
    const auto found = directed.find(key(Origin(Next(h)), Origin(h)));
    if (found == directed.end()) Refuse("the mesh is open: " + name(h) + " has one face only");
    twin_[h] = found->second;
    edge_[h] = twin_[h] < h ? edge_[twin_[h]] : edges++;
  }
}

void QuadTopology::FindFans() {
  for (int h = 0; h < half_edges(); ++h) {
    ++valence_[Origin(h)];
    if (outgoing_[Origin(h)] < 0) outgoing_[Origin(h)] = h;
  }
  for (int v = 0; v < vertices(); ++v) {
    if (outgoing_[v] < 0) Refuse(VertexName(v) + " belongs to no face");
    int turned = 0;
    int h = outgoing_[v];
    do {
      h = Turned(h);
      ++turned;
    } while (h != outgoing_[v] && turned <= valence_[v]);
    if (turned != valence_[v]) {
      Refuse("at " + VertexName(v) + " several sheets touch: it is not manifold");
    }
    if (valence_[v] < 3) Refuse(VertexName(v) + " has two edges only");
  }
}

std::vector<int> QuadTopology::Parts(bool smooth) const {
  std::vector<int> component(faces(), -1), open;
  int count = 0;
  for (int first = 0; first < faces(); ++first) {
    if (component[first] >= 0) continue;
    component[first] = count;
    open.push_back(first);
    while (!open.empty()) {
      const int f = open.back();
      open.pop_back();
      for (int k = 0; k < 4; ++k) {
        const int beside = twin_[4 * f + k] >> 2;
        if (component[beside] >= 0 || (smooth && IsCrease(4 * f + k))) continue;
        component[beside] = count;
        open.push_back(beside);
      }
    }
    ++count;
  }
  return component;
}

}  // namespace internal

QuadMeshSummary CheckQuadMesh(const QuadMesh& mesh) {
  using namespace internal;
  if (!mesh.vertices.allFinite()) Reject("quad mesh", "a coordinate is not finite");
  const QuadTopology topology(mesh);
  for (const int face : mesh.caps) {
    if (face < 0 || face >= topology.faces())
      Reject("quad mesh", "a cap is a face that is not there");
  }
  QuadMeshSummary summary;
  const std::vector<int> component = topology.Components();
  summary.components = *std::max_element(component.begin(), component.end()) + 1;
  const int euler = topology.vertices() - topology.edges() + topology.faces();
  summary.genus = summary.components - euler / 2;
  summary.least_valence = summary.greatest_valence = topology.Valence(0);
  for (int v = 0; v < topology.vertices(); ++v) {
    summary.least_valence = std::min(summary.least_valence, topology.Valence(v));
    summary.greatest_valence = std::max(summary.greatest_valence, topology.Valence(v));
    summary.extraordinary += topology.Valence(v) != 4;
  }
  const Eigen::Vector3d middle = mesh.vertices.rowwise().mean();
  std::vector<double> volumes(summary.components, 0.0);
  for (int f = 0; f < topology.faces(); ++f) {
    Eigen::Matrix<double, 3, 4> corner;
    for (int k = 0; k < 4; ++k) corner.col(k) = mesh.vertices.col(mesh.faces(k, f)) - middle;
    const Eigen::Vector3d centre = corner.rowwise().mean();
    for (int k = 0; k < 4; ++k) {
      volumes[component[f]] += corner.col(k).cross(corner.col((k + 1) % 4)).dot(centre) / 6;
    }
  }
  for (const double volume : volumes) {
    if (!(volume > 0)) {
      Reject("quad mesh",
             "its faces are clockwise seen from outside (a component has no positive volume): "
             "turn them");
    }
    summary.volume += volume;
  }
  return summary;
}

}  // namespace batten
