// SPDX-License-Identifier: MIT
#include "batten/fitting/closed_surface.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <set>
#include <string>
#include <utility>

#include "batten/fitting/faceted_solid.h"
#include "batten/fitting/neighbours.h"
#include "batten/fitting/refused_data.h"
#include "fitting/neighbours/signed_sets.h"
#include "fitting/solid/triangle_curvature.h"
#include "geometry/mesh/half_edges.h"
#include "geometry/mesh/point_numbers.h"
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
  PointNumbers places;
  for (Eigen::Index v = 0; v < vertices.cols(); ++v) {
    joined.place.push_back(-1);
    if (!used[std::size_t(v)]) continue;
    const int before = places.size(), place = places.NumberOf(vertices.col(v).data());
    if (place == before) joined.points.push_back(vertices.col(v));
    joined.joined += place < before;
    joined.place.back() = place;
  }
  return joined;
}

Eigen::Map<const Eigen::Matrix3Xi> CornersOf(const std::vector<Triangle>& triangles) {
  return {triangles.front().data(), 3, Eigen::Index(triangles.size())};
}

// Whether a turn at b, from a to c, is to the left seen against the normal.
bool TurnsLeft(const Eigen::Vector3d& a,
               const Eigen::Vector3d& b,
               const Eigen::Vector3d& c,
               const Eigen::Vector3d& normal) {
  return (b - a).cross(c - b).dot(normal) > 0;
}

// A face's corners three by three: a fan where it is convex, else its ears one after the other.
std::vector<Triangle> Cut(std::vector<int> face, const std::vector<Eigen::Vector3d>& points) {
  const auto at = [&](std::size_t k) -> const Eigen::Vector3d& {
    return points[std::size_t(face[k % face.size()])];
  };
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  // [Newell]
  for (std::size_t k = 1; k + 1 < face.size(); ++k)
    normal += (at(k) - at(0)).cross(at(k + 1) - at(0));
  const auto is_ear = [&](std::size_t k) {
    const std::size_t n = face.size();
    const Eigen::Vector3d &a = at(k + n - 1), &b = at(k), &c = at(k + 1);
    if (!TurnsLeft(a, b, c, normal)) return false;
    for (std::size_t other = 0; other < n; ++other) {
      const Eigen::Vector3d& p = at(other);
      if (p == a || p == b || p == c) continue;
      if (!TurnsLeft(a, p, b, normal) && !TurnsLeft(b, p, c, normal) && !TurnsLeft(c, p, a, normal))
        return false;
    }
    return true;
  };
  const auto convex = [&] {
    for (std::size_t k = 0; k < face.size(); ++k) {
      if (TurnsLeft(at(k + 2), at(k + 1), at(k), normal)) return false;
    }
    return true;
  };
  std::vector<Triangle> triangles;
  if (face.size() > 3 && !convex()) {
    for (std::size_t k = 0, missed = 0; face.size() > 3 && missed < face.size();) {
      k %= face.size();
      if (!is_ear(k)) {
        ++k, ++missed;
        continue;
      }
      const std::size_t n = face.size();
      triangles.push_back({face[(k + n - 1) % n], face[k], face[(k + 1) % n]});
      face.erase(face.begin() + std::ptrdiff_t(k));
      missed = 0;
    }
  }
  for (std::size_t k = 1; k + 1 < face.size(); ++k)
    triangles.push_back({face[0], face[k], face[k + 1]});
  return triangles;
}

// Triangles of faces, less those without area or there twice; `dropped` counts these.
std::vector<Triangle> CutFaces(const std::vector<std::vector<int>>& faces,
                               const JoinedPoints& joined,
                               int& dropped) {
  std::vector<Triangle> all;
  all.reserve(faces.size());
  const auto add = [&](const Triangle& t) {
    if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) {
      ++dropped;
    } else {
      all.push_back(t);
    }
  };
  const auto place = [&](int v) { return joined.place[std::size_t(v)]; };
  for (const std::vector<int>& face : faces) {
    if (face.size() == 3) {
      add({place(face[0]), place(face[1]), place(face[2])});
      continue;
    }
    std::vector<int> corners(face.size());
    std::transform(face.begin(), face.end(), corners.begin(), place);
    for (const Triangle& t : Cut(std::move(corners), joined.points)) add(t);
  }
  if (all.empty()) throw RefusedData("there are no faces with an area");
  const std::vector<bool> repeated = RepeatedTriangles(CornersOf(all), int(joined.points.size()));
  std::vector<Triangle> triangles;
  triangles.reserve(all.size());
  for (std::size_t t = 0; t < all.size(); ++t) {
    if (!repeated[t]) triangles.push_back(all[t]);
  }
  dropped += int(all.size() - triangles.size());
  return triangles;
}

HalfEdges EdgesOf(const std::vector<Triangle>& triangles, std::size_t vertices) {
  return LinkTriangles(CornersOf(triangles), int(vertices));
}

int OriginOf(const std::vector<Triangle>& triangles, int h) {
  return triangles[std::size_t(h / 3)][std::size_t(h % 3)];
}

// Half-edges of edges that only one triangle has.
std::vector<int> BorderHalves(const HalfEdges& edges) {
  std::vector<bool> crowded(edges.twin.size());
  for (const std::vector<int>& all : edges.crowded) {
    for (const int h : all) crowded[std::size_t(h)] = true;
  }
  std::vector<int> border;
  for (std::size_t h = 0; h < crowded.size(); ++h) {
    if (edges.twin[h] < 0 && !crowded[h]) border.push_back(int(h));
  }
  return border;
}

// The ends of edges that only one triangle has, and the number of these edges.
std::vector<int> BorderVertices(const std::vector<Triangle>& triangles,
                                std::size_t vertices,
                                std::size_t& edges) {
  std::set<int> ends;
  const std::vector<int> border = BorderHalves(EdgesOf(triangles, vertices));
  edges = border.size();
  for (const int h : border) {
    ends.insert(OriginOf(triangles, h));
    ends.insert(OriginOf(triangles, NextHalf(h)));
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
  std::vector<int> borders = BorderVertices(mesh.triangles, mesh.points.size(), open);
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
    std::vector<int> next = BorderVertices(triangles, mesh.points.size(), left);
    if (left >= open) continue;
    mesh.triangles = std::move(triangles);
    borders = std::move(next);
    open = left;
    welded = true;
  }
  return welded ? DropUnused(mesh) : 0;
}

// Pairs the triangles at edges that more than two have, as of bodies that touch there: between
// those of a pair is the inside of one.
void PairCrowded(const Mesh& mesh, HalfEdges& edges) {
  int unpaired = 0;
  for (const std::vector<int>& all : edges.crowded) {
    const int from = OriginOf(mesh.triangles, all[0]);
    const Eigen::Vector3d& start = mesh.At(from);
    const Eigen::Vector3d along =
        (mesh.At(OriginOf(mesh.triangles, NextHalf(all[0]))) - start).normalized();
    const auto away = [&](int h) -> Eigen::Vector3d {
      const Eigen::Vector3d third = mesh.At(OriginOf(mesh.triangles, PreviousHalf(h))) - start;
      return third - third.dot(along) * along;
    };
    const Eigen::Vector3d first = away(all[0]);
    std::vector<std::pair<double, int>> around;  // by angle, anticlockwise about the edge
    for (const int h : all) {
      const Eigen::Vector3d other = away(h);
      around.emplace_back(std::atan2(first.cross(other).dot(along), first.dot(other)), h);
    }
    std::sort(around.begin(), around.end());
    // A triangle that runs along has its inside clockwise of it.
    const auto runs_along = [&](std::size_t k) {
      return OriginOf(mesh.triangles, around[k % around.size()].second) == from;
    };
    bool paired = true;
    for (std::size_t k = 0; k < around.size(); ++k)
      paired = paired && runs_along(k) != runs_along(k + 1);
    unpaired += !paired;
    for (std::size_t k = 0; paired && k < around.size(); ++k) {
      const std::size_t beside = (runs_along(k) ? k + around.size() - 1 : k + 1) % around.size();
      edges.twin[std::size_t(around[k].second)] = around[beside].second;
    }
  }
  if (unpaired > 0) {
    throw RefusedData("more than two faces meet at " + std::to_string(unpaired) +
                      (unpaired == 1 ? " edge" : " edges") +
                      ", and not as bodies that touch there: the mesh is not manifold");
  }
  edges.crowded.clear();
}

// Turns the triangles of every part as its first is; `turned` counts them.
MeshParts TurnAlike(std::vector<Triangle>& triangles, HalfEdges& edges, int& turned) {
  SignedSets sets(Eigen::Index(triangles.size()));
  for (int h = 0; h < int(edges.twin.size()); ++h) {
    const int twin = edges.twin[std::size_t(h)];
    if (twin < h) continue;
    const int alike = OriginOf(triangles, h) == OriginOf(triangles, twin);
    if (!sets.Join(h / 3, twin / 3, alike) &&
        (sets.Find(h / 3).second ^ sets.Find(twin / 3).second) != alike) {
      throw RefusedData("the surface has one side only: its faces can't be turned alike");
    }
  }
  MeshParts parts{std::vector<int>(triangles.size(), -1)};
  std::vector<std::pair<int, int>> known(triangles.size(), {-1, 0});  // of roots: part, its sign
  std::vector<bool> flipped(triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const auto [root, flip] = sets.Find(int(t));
    auto& [part, sign] = known[std::size_t(root)];
    if (part < 0) part = parts.count++, sign = flip;
    parts.of[t] = part;
    flipped[t] = flip != sign;
  }
  // Corners 1 and 2 change places, and with them half-edges 0 and 2.
  const auto after = [&](int h) {
    return h >= 0 && flipped[std::size_t(h / 3)] && h % 3 != 1 ? 3 * (h / 3) + 2 - h % 3 : h;
  };
  std::vector<int> twin(edges.twin.size());
  for (int h = 0; h < int(twin.size()); ++h)
    twin[std::size_t(after(h))] = after(edges.twin[std::size_t(h)]);
  edges.twin = std::move(twin);
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    if (!flipped[t]) continue;
    std::swap(triangles[t][1], triangles[t][2]);
    ++turned;
  }
  return parts;
}

// Fans that meet at a vertex only get a vertex each.
void PartVertices(Mesh& mesh, const HalfEdges& edges) {
  SignedSets fans(Eigen::Index(edges.twin.size()));  // of corners
  for (int h = 0; h < int(edges.twin.size()); ++h) {
    const int twin = edges.twin[std::size_t(h)];
    if (twin < 0) continue;
    fans.Join(h, NextHalf(twin));
  }
  // The last fan of a vertex keeps it.
  std::vector<int> own(mesh.points.size(), -1), number(edges.twin.size(), -1);
  for (int corner = int(edges.twin.size()); corner-- > 0;) {
    int& v = mesh.triangles[std::size_t(corner / 3)][std::size_t(corner % 3)];
    int& of_fan = number[std::size_t(fans.Find(corner).first)];
    if (of_fan < 0) {
      of_fan = v;
      if (own[std::size_t(v)] >= 0) {
        of_fan = int(mesh.points.size());
        mesh.points.push_back(mesh.At(v));
      }
      own[std::size_t(v)] = of_fan;
    }
    v = of_fan;
  }
}

// Closes holes, by triangles of the part around; their number.
int FillHoles(Mesh& mesh, MeshParts& parts, const HalfEdges& edges) {
  struct Step {
    int to, part;
  };
  std::map<int, Step> next;  // against the direction of the border's triangles
  for (const int h : BorderHalves(edges)) {
    next[OriginOf(mesh.triangles, NextHalf(h))] = {OriginOf(mesh.triangles, h),
                                                   parts.of[std::size_t(h / 3)]};
  }
  int filled = 0;
  while (!next.empty()) {
    const int part = next.begin()->second.part;
    std::vector<int> loop;
    for (auto step = next.begin(); step != next.end();) {
      loop.push_back(step->first);
      const int to = step->second.to;
      next.erase(step);
      step = next.find(to);
    }
    ++filled;
    if (loop.size() == 3) {
      mesh.triangles.push_back({loop[0], loop[1], loop[2]});
    } else {
      Eigen::Vector3d middle = Eigen::Vector3d::Zero();
      for (const int v : loop) middle += mesh.At(v) / double(loop.size());
      const int centre = int(mesh.points.size());
      mesh.points.push_back(middle);
      for (std::size_t k = 0; k < loop.size(); ++k)
        mesh.triangles.push_back({loop[k], loop[(k + 1) % loop.size()], centre});
    }
    parts.of.resize(mesh.triangles.size(), part);
  }
  return filled;
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

// Six times the volume of a tetrahedron.
double SixVolume(const Eigen::Vector3d& a,
                 const Eigen::Vector3d& b,
                 const Eigen::Vector3d& c,
                 const Eigen::Vector3d& d) {
  return (b - a).cross(c - a).dot(d - a);
}

// How often triangles wind round a point: 1 inside a body, 0 outside. [van Oosterom & Strackee
// 1983]
double WindingAbout(const Eigen::Vector3d& p, const Mesh& mesh, const std::vector<int>& triangles) {
  double angle = 0;
  for (const int t : triangles) {
    const Triangle& corners = mesh.triangles[std::size_t(t)];
    const Eigen::Vector3d a = mesh.At(corners[0]) - p, b = mesh.At(corners[1]) - p,
                          c = mesh.At(corners[2]) - p;
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    angle += 2 * std::atan2(a.dot(b.cross(c)),
                            la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return angle / (4 * EIGEN_PI);
}

Eigen::AlignedBox3d BoxOf(const Mesh& mesh, int t) {
  Eigen::AlignedBox3d box;
  for (const int v : mesh.triangles[std::size_t(t)]) box.extend(mesh.At(v));
  return box;
}

// Whether an edge of a triangle passes through another, not merely to it.
bool Pierces(const Mesh& mesh, const Triangle& one, const Triangle& other, double least) {
  const Eigen::Vector3d &a = mesh.At(other[0]), &b = mesh.At(other[1]), &c = mesh.At(other[2]);
  for (std::size_t k = 0; k < 3; ++k) {
    const Eigen::Vector3d &p = mesh.At(one[k]), &q = mesh.At(one[(k + 1) % 3]);
    const double before = SixVolume(a, b, c, p), behind = SixVolume(a, b, c, q);
    if (!(std::min(before, behind) < -least && std::max(before, behind) > least)) continue;
    const double u = SixVolume(p, q, a, b), v = SixVolume(p, q, b, c), w = SixVolume(p, q, c, a);
    if ((u > least && v > least && w > least) || (u < -least && v < -least && w < -least))
      return true;
  }
  return false;
}

// Of bodies one may be a cavity of another, or run through it: then all of them are no solids.
void RefuseBodiesInOneAnother(const Mesh& mesh, const MeshParts& parts) {
  constexpr double kRounding = 1e-9;   // rounding, of the cube of the size and of a whole turn
  constexpr double kMostPairs = 1e9;   // budget: pairs of triangles, looked at in some seconds
  constexpr std::size_t kPlaces = 32;  // budget: vertices told to be inside or outside
  std::vector<Eigen::AlignedBox3d> boxes(std::size_t(parts.count));
  std::vector<std::vector<int>> triangles(std::size_t(parts.count));
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    boxes[std::size_t(parts.of[t])].extend(BoxOf(mesh, int(t)));
    triangles[std::size_t(parts.of[t])].push_back(int(t));
  }
  const auto refuse = [&](const char* how) {
    throw RefusedData("the faces are " + std::to_string(boxes.size()) + " bodies, of which " + how +
                      ": a hollow body, or several in one another, are not fitted; keep one");
  };
  // On the faces of the other a vertex is half inside, on an edge some other share.
  const auto refuse_inside = [&](std::size_t i, std::size_t j) {
    bool inside = false, outside = false;
    for (std::size_t k = 0; k < kPlaces; ++k) {
      const int t = triangles[i][k * triangles[i].size() / kPlaces];
      const Eigen::Vector3d& p = mesh.At(mesh.triangles[std::size_t(t)][0]);
      const double winding = boxes[j].contains(p) ? WindingAbout(p, mesh, triangles[j]) : 0;
      inside = inside || winding > 1 - kRounding;
      outside = outside || winding < kRounding;
    }
    if (inside) refuse(outside ? "two run through one another" : "one lies in another");
  };
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    for (std::size_t j = i + 1; j < boxes.size(); ++j) {
      const Eigen::AlignedBox3d common = boxes[i].intersection(boxes[j]);
      if (common.isEmpty()) continue;
      std::vector<int> near_one, near_other;
      for (const int t : triangles[i])
        if (BoxOf(mesh, t).intersects(common)) near_one.push_back(t);
      for (const int t : triangles[j])
        if (BoxOf(mesh, t).intersects(common)) near_other.push_back(t);
      if (double(near_one.size()) * double(near_other.size()) > kMostPairs)
        refuse("two may lie in one another");
      const double least = kRounding * std::pow(boxes[i].merged(boxes[j]).diagonal().norm(), 3);
      for (const int s : near_one) {
        const Eigen::AlignedBox3d box = BoxOf(mesh, s);
        for (const int t : near_other) {
          const Triangle &one = mesh.triangles[std::size_t(s)],
                         &other = mesh.triangles[std::size_t(t)];
          if (box.intersects(BoxOf(mesh, t)) &&
              (Pierces(mesh, one, other, least) || Pierces(mesh, other, one, least)))
            refuse("two run through one another");
        }
      }
      refuse_inside(i, j);
      refuse_inside(j, i);
    }
  }
}

Mesh MeshOf(const TriangleSurface& surface) {
  Mesh mesh;
  mesh.points.assign(surface.vertices.colwise().begin(), surface.vertices.colwise().end());
  mesh.triangles.reserve(std::size_t(surface.triangles.cols()));
  for (const auto t : surface.triangles.colwise()) mesh.triangles.push_back({t[0], t[1], t[2]});
  return mesh;
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

FaceSurface SurfaceOfFaces(const Eigen::Matrix3Xd& vertices,
                           const std::vector<std::vector<int>>& faces) {
  FaceSurface result;
  JoinedPoints joined = JoinPoints(vertices, faces);
  result.joined = joined.joined;
  std::vector<Triangle> triangles = CutFaces(faces, joined, result.dropped);
  Mesh mesh{std::move(joined.points), std::move(triangles)};
  result.joined += WeldBorders(mesh, SinglePrecisionOf(vertices));
  const HalfEdges edges = EdgesOf(mesh.triangles, mesh.points.size());
  result.open_edges = int(BorderHalves(edges).size());
  result.crowded_edges = int(edges.crowded.size());
  result.surface = SurfaceOf(mesh);
  return result;
}

ClosedSurface CloseSurface(const Eigen::Matrix3Xd& vertices,
                           const std::vector<std::vector<int>>& faces,
                           double most_filled) {
  return CloseSurface(SurfaceOfFaces(vertices, faces), most_filled);
}

ClosedSurface CloseSurface(const FaceSurface& faces, double most_filled) {
  ClosedSurface closed;
  closed.joined = faces.joined;
  closed.dropped = faces.dropped;
  Mesh mesh = MeshOf(faces.surface);
  HalfEdges edges = EdgesOf(mesh.triangles, mesh.points.size());
  PairCrowded(mesh, edges);
  MeshParts parts = TurnAlike(mesh.triangles, edges, closed.turned);
  PartVertices(mesh, edges);
  const std::size_t given = mesh.triangles.size();
  closed.filled = FillHoles(mesh, parts, edges);
  if (closed.filled > 0) {
    const TriangleSurface whole = SurfaceOf(mesh);
    double area = 0;
    for (std::size_t t = 0; t < given; ++t) area += NormalOf(whole, Eigen::Index(t)).norm() / 2;
    closed.filled_share = 1 - area / AreaOf(whole);
  }
  if (closed.filled_share > most_filled) throw OpenSurface(closed.filled, closed.filled_share);
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
