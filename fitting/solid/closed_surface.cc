// SPDX-License-Identifier: MIT
#include "batten/fitting/closed_surface.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <numeric>
#include <set>
#include <string>
#include <unordered_map>
#include <utility>

#include "batten/fitting/faceted_solid.h"
#include "batten/fitting/neighbours.h"
#include "batten/fitting/refused_data.h"
#include "fitting/solid/triangle_curvature.h"
#include "geometry/mesh/triangle_measure.h"
#include "geometry/numeric/number_text.h"

namespace batten {
namespace internal {
namespace {

using Triangle = std::array<int, 3>;

// What a surface is made of while it is closed.
struct Mesh {
  std::vector<Eigen::Vector3d> points;
  std::vector<Triangle> triangles;

  const Eigen::Vector3d& At(int v) const { return points[std::size_t(v)]; }
};

// Of every triangle the number of the connected part that it is of.
struct MeshParts {
  std::vector<int> of;
  int count = 0;
};

// A point for every place of vertices that faces use; −1: of no face.
struct JoinedPoints {
  std::vector<Eigen::Vector3d> points;
  std::vector<int> place;  // of every vertex
  int joined = 0;
};

JoinedPoints JoinPoints(const Eigen::Matrix3Xd& vertices,
                        const std::vector<std::vector<int>>& faces) {
  std::vector<bool> used(std::size_t(vertices.cols()), false);
  for (const std::vector<int>& face : faces) {
    for (const int v : face) used[std::size_t(v)] = true;
  }
  JoinedPoints joined;
  std::map<std::array<double, 3>, int> places;
  for (Eigen::Index v = 0; v < vertices.cols(); ++v) {
    if (!used[std::size_t(v)]) {
      joined.place.push_back(-1);
      continue;
    }
    const auto [found, fresh] = places.try_emplace({vertices(0, v), vertices(1, v), vertices(2, v)},
                                                   int(joined.points.size()));
    if (fresh) joined.points.push_back(vertices.col(v));
    joined.joined += !fresh;
    joined.place.push_back(found->second);
  }
  return joined;
}

// Triangles of faces, less those without area or there twice; `dropped` counts these.
std::vector<Triangle> CutFaces(const std::vector<std::vector<int>>& faces,
                               const std::vector<int>& place,
                               int& dropped) {
  std::vector<Triangle> triangles;
  std::set<Triangle> known;
  for (const std::vector<int>& face : faces) {
    for (std::size_t k = 1; k + 1 < face.size(); ++k) {
      const Triangle triangle = {place[std::size_t(face[0])],
                                 place[std::size_t(face[k])],
                                 place[std::size_t(face[k + 1])]};
      Triangle sorted = triangle;
      std::sort(sorted.begin(), sorted.end());
      const bool flat = sorted[0] == sorted[1] || sorted[1] == sorted[2];
      if (flat || !known.insert(sorted).second) {
        ++dropped;
      } else {
        triangles.push_back(triangle);
      }
    }
  }
  if (triangles.empty()) throw RefusedData("there are no faces with an area");
  return triangles;
}

// Edges without their direction.
std::int64_t KeyOf(int a, int b) {
  return std::int64_t{std::min(a, b)} << 32 | std::uint32_t(std::max(a, b));
}

using EdgeFaces = std::unordered_map<std::int64_t, std::vector<int>>;

EdgeFaces EdgesOf(const std::vector<Triangle>& triangles) {
  EdgeFaces edges;
  edges.reserve(2 * triangles.size());
  for (int t = 0; t < int(triangles.size()); ++t) {
    const Triangle& own = triangles[std::size_t(t)];
    for (std::size_t k = 0; k < 3; ++k) edges[KeyOf(own[k], own[(k + 1) % 3])].push_back(t);
  }
  return edges;
}

// The ends of edges that only one triangle has, and the number of these edges.
std::vector<int> BorderVertices(const std::vector<Triangle>& triangles, std::size_t& edges) {
  std::set<int> ends;
  edges = 0;
  for (const auto& [key, faces] : EdgesOf(triangles)) {
    if (faces.size() != 1) continue;
    ++edges;
    ends.insert(int(key >> 32));
    ends.insert(int(key & 0xffffffff));
  }
  return {ends.begin(), ends.end()};
}

// Of every vertex the one that stands for it: the first of the given ones within `reach`, else
// itself.
std::vector<int> Welded(const Mesh& mesh, std::vector<int> vertices, double reach) {
  std::vector<int> stands(mesh.points.size());
  std::iota(stands.begin(), stands.end(), 0);
  std::stable_sort(vertices.begin(), vertices.end(), [&](int a, int b) {
    return mesh.At(a).x() < mesh.At(b).x();
  });
  for (std::size_t k = 0; k < vertices.size(); ++k) {
    const Eigen::Vector3d& p = mesh.At(vertices[k]);
    for (std::size_t j = k; j-- > 0 && p.x() - mesh.At(vertices[j]).x() <= reach;) {
      const int first = stands[std::size_t(vertices[j])];
      if ((mesh.At(first) - p).norm() > reach) continue;
      stands[std::size_t(vertices[k])] = first;
      break;
    }
  }
  return stands;
}

// Points of no triangle go; returns how many.
int DropUnused(Mesh& mesh) {
  std::vector<int> number(mesh.points.size(), -1);
  std::vector<Eigen::Vector3d> points;
  for (Triangle& t : mesh.triangles) {
    for (int& v : t) {
      int& n = number[std::size_t(v)];
      if (n < 0) {
        n = int(points.size());
        points.push_back(mesh.At(v));
      }
      v = n;
    }
  }
  const int dropped = int(mesh.points.size() - points.size());
  mesh.points = std::move(points);
  return dropped;
}

// Joins vertices of open edges that are one but for the last digits of their file: within single
// precision, then farther while that closes edges and makes no triangle vanish. Returns how many
// were joined.
int WeldBorders(Mesh& mesh, double precision) {
  constexpr double kStep = 4;     // budget: a dozen rounds
  constexpr double kMost = 1e-3;  // level: no vertex moves by more of the size
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& p : mesh.points) box.extend(p);
  std::size_t open = 0;
  std::vector<int> borders = BorderVertices(mesh.triangles, open);
  bool welded = false;
  for (double reach = precision; open > 0 && reach > 0 && reach < kMost * box.diagonal().norm();
       reach *= kStep) {
    const std::vector<int> stands = Welded(mesh, borders, reach);
    std::vector<Triangle> triangles = mesh.triangles;
    bool vanishes = false;
    for (Triangle& t : triangles) {
      for (int& v : t) v = stands[std::size_t(v)];
      vanishes = vanishes || t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
    }
    if (vanishes) break;
    std::size_t left = 0;
    std::vector<int> next = BorderVertices(triangles, left);
    if (left >= open) continue;
    mesh.triangles = std::move(triangles);
    borders = std::move(next);
    open = left;
    welded = true;
  }
  return welded ? DropUnused(mesh) : 0;
}

bool RunsAlong(const Triangle& t, int a, int b) {
  return (t[0] == a && t[1] == b) || (t[1] == a && t[2] == b) || (t[2] == a && t[0] == b);
}

// Turns the triangles of every part as its first is; `turned` counts them.
MeshParts TurnAlike(std::vector<Triangle>& triangles, int& turned) {
  const EdgeFaces edges = EdgesOf(triangles);
  int crowded = 0;
  for (const auto& [key, faces] : edges) crowded += faces.size() > 2;
  if (crowded > 0) {
    throw RefusedData("more than two faces meet at " + std::to_string(crowded) +
                      (crowded == 1 ? " edge" : " edges") + ": the mesh is not manifold");
  }
  MeshParts parts{std::vector<int>(triangles.size(), -1)};
  for (int first = 0; first < int(triangles.size()); ++first) {
    if (parts.of[std::size_t(first)] >= 0) continue;
    std::vector<int> open = {first};
    parts.of[std::size_t(first)] = parts.count;
    while (!open.empty()) {
      const int t = open.back();
      open.pop_back();
      const Triangle own = triangles[std::size_t(t)];
      for (std::size_t k = 0; k < 3; ++k) {
        const int a = own[k], b = own[(k + 1) % 3];
        for (const int beside : edges.at(KeyOf(a, b))) {
          if (beside == t) continue;
          Triangle& other = triangles[std::size_t(beside)];
          const bool same = RunsAlong(other, a, b);
          if (parts.of[std::size_t(beside)] < 0) {
            parts.of[std::size_t(beside)] = parts.count;
            if (same) {
              std::swap(other[1], other[2]);
              ++turned;
            }
            open.push_back(beside);
          } else if (same) {
            throw RefusedData("the surface has one side only: its faces can't be turned alike");
          }
        }
      }
    }
    ++parts.count;
  }
  return parts;
}

bool ShareEdgeAt(int v, const Triangle& one, const Triangle& other) {
  return std::any_of(one.begin(), one.end(), [&](int a) {
    return a != v && std::find(other.begin(), other.end(), a) != other.end();
  });
}

// Takes from the triangles about a vertex those that hang together with the last.
std::vector<int> TakeFan(int v, const std::vector<Triangle>& triangles, std::vector<int>& left) {
  std::vector<int> fan = {left.back()};
  left.pop_back();
  for (std::size_t k = 0; k < fan.size(); ++k) {
    for (std::size_t m = 0; m < left.size();) {
      if (ShareEdgeAt(v, triangles[std::size_t(fan[k])], triangles[std::size_t(left[m])])) {
        fan.push_back(left[m]);
        left.erase(left.begin() + std::ptrdiff_t(m));
      } else {
        ++m;
      }
    }
  }
  return fan;
}

// Fans that meet at a vertex only get a vertex each.
void PartVertices(Mesh& mesh) {
  std::vector<std::vector<int>> around(mesh.points.size());
  for (int t = 0; t < int(mesh.triangles.size()); ++t) {
    for (const int v : mesh.triangles[std::size_t(t)]) around[std::size_t(v)].push_back(t);
  }
  for (int v = 0; v < int(around.size()); ++v) {
    std::vector<int>& left = around[std::size_t(v)];
    if (!left.empty()) TakeFan(v, mesh.triangles, left);  // keeps the vertex
    while (!left.empty()) {
      const int copy = int(mesh.points.size());
      mesh.points.push_back(mesh.At(v));
      for (const int t : TakeFan(v, mesh.triangles, left)) {
        Triangle& triangle = mesh.triangles[std::size_t(t)];
        std::replace(triangle.begin(), triangle.end(), v, copy);
      }
    }
  }
}

// Closes holes; their number.
int FillHoles(Mesh& mesh) {
  std::unordered_map<int, int> next;  // against the direction of the border's faces
  for (const auto& [key, faces] : EdgesOf(mesh.triangles)) {
    if (faces.size() != 1) continue;
    const int a = int(key >> 32), b = int(key & 0x7FFFFFFF);
    if (RunsAlong(mesh.triangles[std::size_t(faces[0])], a, b)) {
      next[b] = a;
    } else {
      next[a] = b;
    }
  }
  int filled = 0;
  while (!next.empty()) {
    int least = next.begin()->first;
    for (const auto& [from, to] : next) least = std::min(least, from);
    std::vector<int> loop;
    for (int v = least; next.contains(v);) {
      loop.push_back(v);
      const int to = next.at(v);
      next.erase(v);
      v = to;
    }
    ++filled;
    if (loop.size() == 3) {
      mesh.triangles.push_back({loop[0], loop[1], loop[2]});
      continue;
    }
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (const int v : loop) middle += mesh.At(v) / double(loop.size());
    const int centre = int(mesh.points.size());
    mesh.points.push_back(middle);
    for (std::size_t k = 0; k < loop.size(); ++k)
      mesh.triangles.push_back({loop[k], loop[(k + 1) % loop.size()], centre});
  }
  return filled;
}

// Triangles that were filled in belong to the part across their edges.
void SpreadParts(const std::vector<Triangle>& triangles, MeshParts& parts) {
  const EdgeFaces edges = EdgesOf(triangles);
  parts.of.resize(triangles.size(), -1);
  for (bool more = true; more;) {
    more = false;
    for (std::size_t t = 0; t < triangles.size(); ++t) {
      for (std::size_t k = 0; k < 3 && parts.of[t] < 0; ++k) {
        for (const int beside : edges.at(KeyOf(triangles[t][k], triangles[t][(k + 1) % 3]))) {
          if (parts.of[std::size_t(beside)] < 0) continue;
          parts.of[t] = parts.of[std::size_t(beside)];
          more = true;
        }
      }
    }
  }
}

void TurnOutwards(const MeshParts& parts, Mesh& mesh) {
  std::vector<double> volumes(std::size_t(parts.count), 0.0);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Triangle& one = mesh.triangles[t];
    const Eigen::Vector3d a = mesh.At(one[0]) - mesh.points[0];
    const Eigen::Vector3d b = mesh.At(one[1]) - mesh.points[0];
    const Eigen::Vector3d c = mesh.At(one[2]) - mesh.points[0];
    volumes[std::size_t(parts.of[t])] += a.cross(b).dot(c);
  }
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    Triangle& one = mesh.triangles[t];
    if (volumes[std::size_t(parts.of[t])] < 0) std::swap(one[1], one[2]);
  }
}

// Of bodies one may be a cavity of another, or run through it: then all of them are no solids.
void RefuseBodiesInOneAnother(const Mesh& mesh, const MeshParts& parts) {
  std::vector<Eigen::AlignedBox3d> boxes(std::size_t(parts.count));
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (const int v : mesh.triangles[t]) boxes[std::size_t(parts.of[t])].extend(mesh.At(v));
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    for (std::size_t j = i + 1; j < boxes.size(); ++j) {
      if (!boxes[i].intersects(boxes[j])) continue;
      throw RefusedData("the faces are " + std::to_string(boxes.size()) +
                        " bodies, of which two lie in one another or touch: a hollow body, or "
                        "several that meet, are not fitted; keep one");
    }
  }
}

TriangleSurface SurfaceOf(const Mesh& mesh) {
  TriangleSurface surface;
  surface.vertices.resize(3, Eigen::Index(mesh.points.size()));
  for (std::size_t k = 0; k < mesh.points.size(); ++k)
    surface.vertices.col(Eigen::Index(k)) = mesh.points[k];
  surface.triangles.resize(3, Eigen::Index(mesh.triangles.size()));
  for (std::size_t k = 0; k < mesh.triangles.size(); ++k) {
    const Triangle& t = mesh.triangles[k];
    surface.triangles.col(Eigen::Index(k)) << t[0], t[1], t[2];
  }
  return surface;
}

RefusedData OpenSurface(int holes, double share) {
  return RefusedData("the surface is open: its " +
                         (holes == 1 ? "hole" : std::to_string(holes) + " holes") + " would be " +
                         NumberText(std::round(share * 1000) / 10) + " % of its area",
                     Remedy::kLeaveOpen);
}

}  // namespace
}  // namespace internal

using namespace internal;

ClosedSurface CloseSurface(const Eigen::Matrix3Xd& vertices,
                           const std::vector<std::vector<int>>& faces,
                           double most_filled) {
  ClosedSurface closed;
  JoinedPoints joined = JoinPoints(vertices, faces);
  closed.joined = joined.joined;
  Mesh mesh{std::move(joined.points), CutFaces(faces, joined.place, closed.dropped)};
  closed.joined += WeldBorders(mesh, SinglePrecisionOf(vertices));
  MeshParts parts = TurnAlike(mesh.triangles, closed.turned);
  PartVertices(mesh);
  const double area = AreaOf(SurfaceOf(mesh));
  closed.filled = FillHoles(mesh);
  closed.filled_share = 1 - area / AreaOf(SurfaceOf(mesh));
  if (closed.filled_share > most_filled) throw OpenSurface(closed.filled, closed.filled_share);
  SpreadParts(mesh.triangles, parts);
  TurnOutwards(parts, mesh);
  RefuseBodiesInOneAnother(mesh, parts);
  closed.surface = SurfaceOf(mesh);
  const int euler = int(mesh.points.size()) - int(mesh.triangles.size()) / 2;
  closed.components = parts.count;
  closed.genus = parts.count - euler / 2;
  return closed;
}

Eigen::Matrix3Xd NormalsNear(const TriangleSurface& surface, const Eigen::Matrix3Xd& points) {
  const Eigen::Matrix3Xd normals = VertexNormals(surface);
  const std::vector<int> nearest = NeighbourIndex(surface.vertices).Nearest(points, 1);
  Eigen::Matrix3Xd found(3, points.cols());
  for (Eigen::Index k = 0; k < points.cols(); ++k)
    found.col(k) = normals.col(nearest[std::size_t(k)]);
  return found;
}

}  // namespace batten
