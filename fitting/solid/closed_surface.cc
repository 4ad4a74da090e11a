// SPDX-License-Identifier: MIT
#include "batten/fitting/closed_surface.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <unordered_map>
#include <utility>

#include "batten/fitting/neighbours.h"
#include "batten/fitting/refused_data.h"
#include "geometry/numeric/number_text.h"

namespace batten {
namespace internal {
namespace {

using Triangle = std::array<int, 3>;

std::int64_t KeyOf(int a, int b) { return std::int64_t{a} << 32 | std::uint32_t(b); }

// The stages of CloseSurface over a list of triangles.
class Closer {
 public:
  Closer(const Eigen::Matrix3Xd& vertices, const std::vector<std::vector<int>>& faces) {
    std::map<std::array<double, 3>, int> places;
    std::vector<int> place;
    std::vector<bool> used(std::size_t(vertices.cols()), false);
    for (const std::vector<int>& face : faces) {
      for (const int v : face) used[std::size_t(v)] = true;
    }
    for (Eigen::Index v = 0; v < vertices.cols(); ++v) {
      if (!used[std::size_t(v)]) {
        place.push_back(-1);
        continue;
      }
      const auto [found, fresh] =
          places.try_emplace({vertices(0, v), vertices(1, v), vertices(2, v)}, int(points_.size()));
      if (fresh) points_.push_back(vertices.col(v));
      closed_.joined += !fresh;
      place.push_back(found->second);
    }
    std::set<Triangle> known;
    for (const std::vector<int>& face : faces) {
      for (std::size_t k = 1; k + 1 < face.size(); ++k) {
        Triangle triangle = {place[std::size_t(face[0])],
                             place[std::size_t(face[k])],
                             place[std::size_t(face[k + 1])]};
        Triangle sorted = triangle;
        std::sort(sorted.begin(), sorted.end());
        const bool flat = sorted[0] == sorted[1] || sorted[1] == sorted[2];
        if (flat || !known.insert(sorted).second) {
          ++closed_.dropped;
        } else {
          triangles_.push_back(triangle);
        }
      }
    }
    if (triangles_.empty()) throw RefusedData("there are no faces with an area");
  }

  ClosedSurface Close(double most_filled) && {
    Turn();
    PartVertices();
    const double area = Area();
    Fill();
    closed_.filled_share = 1 - area / Area();
    if (closed_.filled_share > most_filled) {
      throw RefusedData(
          "the surface is open: its " +
              (closed_.filled == 1 ? "hole" : std::to_string(closed_.filled) + " holes") +
              " would be " + NumberText(std::round(closed_.filled_share * 1000) / 10) +
              " % of its area",
          Remedy::kLeaveOpen);
    }
    TurnOutwards();
    RefuseBodiesInOneAnother();
    ClosedSurface closed = std::move(closed_);
    closed.surface.vertices.resize(3, Eigen::Index(points_.size()));
    for (std::size_t k = 0; k < points_.size(); ++k) {
      closed.surface.vertices.col(Eigen::Index(k)) = points_[k];
    }
    closed.surface.triangles.resize(3, Eigen::Index(triangles_.size()));
    for (std::size_t k = 0; k < triangles_.size(); ++k) {
      const Triangle& t = triangles_[k];
      closed.surface.triangles.col(Eigen::Index(k)) << t[0], t[1], t[2];
    }
    const int euler = int(points_.size()) - int(triangles_.size()) / 2;
    closed.genus = closed.components - euler / 2;
    return closed;
  }

 private:
  // Faces over every edge, without its direction.
  std::unordered_map<std::int64_t, std::vector<int>> Edges() const {
    std::unordered_map<std::int64_t, std::vector<int>> edges;
    edges.reserve(2 * triangles_.size());
    for (int t = 0; t < int(triangles_.size()); ++t) {
      for (int k = 0; k < 3; ++k) {
        const int a = triangles_[std::size_t(t)][std::size_t(k)];
        const int b = triangles_[std::size_t(t)][std::size_t((k + 1) % 3)];
        edges[KeyOf(std::min(a, b), std::max(a, b))].push_back(t);
      }
    }
    return edges;
  }

  static bool RunsAlong(const Triangle& t, int a, int b) {
    return (t[0] == a && t[1] == b) || (t[1] == a && t[2] == b) || (t[2] == a && t[0] == b);
  }

  void Turn() {
    const auto edges = Edges();
    int crowded = 0;
    for (const auto& [key, faces] : edges) crowded += faces.size() > 2;
    if (crowded > 0) {
      throw RefusedData("more than two faces meet at " + std::to_string(crowded) +
                        (crowded == 1 ? " edge" : " edges") + ": the mesh is not manifold");
    }
    part_.assign(triangles_.size(), -1);
    for (int first = 0; first < int(triangles_.size()); ++first) {
      if (part_[std::size_t(first)] >= 0) continue;
      std::vector<int> open = {first};
      part_[std::size_t(first)] = closed_.components;
      while (!open.empty()) {
        const int t = open.back();
        open.pop_back();
        const Triangle own = triangles_[std::size_t(t)];
        for (int k = 0; k < 3; ++k) {
          const int a = own[std::size_t(k)], b = own[std::size_t((k + 1) % 3)];
          for (const int beside : edges.at(KeyOf(std::min(a, b), std::max(a, b)))) {
            if (beside == t) continue;
            Triangle& other = triangles_[std::size_t(beside)];
            const bool same = RunsAlong(other, a, b);
            if (part_[std::size_t(beside)] < 0) {
              part_[std::size_t(beside)] = closed_.components;
              if (same) {
                std::swap(other[1], other[2]);
                ++closed_.turned;
              }
              open.push_back(beside);
            } else if (same) {
              throw RefusedData("the surface has one side only: its faces can't be turned alike");
            }
          }
        }
      }
      ++closed_.components;
    }
  }

  // Fans that meet at a vertex only get a vertex each.
  void PartVertices() {
    std::vector<std::vector<int>> around(points_.size());
    for (int t = 0; t < int(triangles_.size()); ++t) {
      for (const int v : triangles_[std::size_t(t)]) around[std::size_t(v)].push_back(t);
    }
    const auto count = points_.size();
    for (std::size_t v = 0; v < count; ++v) {
      std::vector<int> left = around[v];
      for (bool first = true; !left.empty(); first = false) {
        std::vector<int> fan = {left.back()};
        left.pop_back();
        for (std::size_t k = 0; k < fan.size(); ++k) {
          for (std::size_t m = 0; m < left.size();) {
            if (SharesEdgeAt(int(v), fan[k], left[m])) {
              fan.push_back(left[m]);
              left.erase(left.begin() + std::ptrdiff_t(m));
            } else {
              ++m;
            }
          }
        }
        if (first) continue;
        const int copy = int(points_.size());
        points_.push_back(points_[v]);
        for (const int t : fan) {
          for (int& corner : triangles_[std::size_t(t)]) {
            if (corner == int(v)) corner = copy;
          }
        }
      }
    }
  }

  bool SharesEdgeAt(int v, int t, int s) const {
    for (const int a : triangles_[std::size_t(t)]) {
      if (a == v) continue;
      for (const int b : triangles_[std::size_t(s)]) {
        if (a == b) return true;
      }
    }
    return false;
  }

  void Fill() {
    std::unordered_map<int, int> next;  // against the direction of the border's faces
    for (const auto& [key, faces] : Edges()) {
      if (faces.size() != 1) continue;
      const int a = int(key >> 32), b = int(key & 0x7FFFFFFF);
      if (RunsAlong(triangles_[std::size_t(faces[0])], a, b)) {
        next[b] = a;
      } else {
        next[a] = b;
      }
    }
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
      ++closed_.filled;
      if (loop.size() == 3) {
        triangles_.push_back({loop[0], loop[1], loop[2]});
        continue;
      }
      Eigen::Vector3d middle = Eigen::Vector3d::Zero();
      for (const int v : loop) middle += points_[std::size_t(v)] / double(loop.size());
      const int centre = int(points_.size());
      points_.push_back(middle);
      for (std::size_t k = 0; k < loop.size(); ++k) {
        triangles_.push_back({loop[k], loop[(k + 1) % loop.size()], centre});
      }
    }
  }

  void TurnOutwards() {
    const auto edges = Edges();
    // Filled triangles belong to the part across their edges.
    for (std::size_t t = part_.size(); t < triangles_.size(); ++t) part_.push_back(-1);
    for (bool more = true; more;) {
      more = false;
      for (std::size_t t = 0; t < triangles_.size(); ++t) {
        for (int k = 0; k < 3 && part_[t] < 0; ++k) {
          const int a = triangles_[t][std::size_t(k)], b = triangles_[t][std::size_t((k + 1) % 3)];
          for (const int beside : edges.at(KeyOf(std::min(a, b), std::max(a, b)))) {
            if (part_[std::size_t(beside)] < 0) continue;
            part_[t] = part_[std::size_t(beside)];
            more = true;
          }
        }
      }
    }
    std::vector<double> volumes(std::size_t(closed_.components), 0.0);
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
      const Triangle& one = triangles_[t];
      const Eigen::Vector3d a = points_[std::size_t(one[0])] - points_[0];
      const Eigen::Vector3d b = points_[std::size_t(one[1])] - points_[0];
      const Eigen::Vector3d c = points_[std::size_t(one[2])] - points_[0];
      volumes[std::size_t(part_[t])] += a.cross(b).dot(c);
    }
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
      if (volumes[std::size_t(part_[t])] < 0) std::swap(triangles_[t][1], triangles_[t][2]);
    }
  }

  // Of bodies one may be a cavity of another, or run through it: then all of them are no solids.
  void RefuseBodiesInOneAnother() const {
    std::vector<Eigen::AlignedBox3d> boxes(std::size_t(closed_.components));
    for (std::size_t t = 0; t < triangles_.size(); ++t)
      for (const int v : triangles_[t])
        boxes[std::size_t(part_[t])].extend(points_[std::size_t(v)]);
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      for (std::size_t j = i + 1; j < boxes.size(); ++j) {
        if (!boxes[i].intersects(boxes[j])) continue;
        throw RefusedData("the faces are " + std::to_string(boxes.size()) +
                          " bodies, of which two lie in one another or touch: a hollow body, or "
                          "several that meet, are not fitted; keep one");
      }
    }
  }

  double Area() const {
    double area = 0;
    for (const Triangle& t : triangles_) {
      const Eigen::Vector3d& a = points_[std::size_t(t[0])];
      area += (points_[std::size_t(t[1])] - a).cross(points_[std::size_t(t[2])] - a).norm() / 2;
    }
    return area;
  }

  std::vector<Eigen::Vector3d> points_;
  std::vector<Triangle> triangles_;
  std::vector<int> part_;
  ClosedSurface closed_;
};

}  // namespace

}  // namespace internal

ClosedSurface CloseSurface(const Eigen::Matrix3Xd& vertices,
                           const std::vector<std::vector<int>>& faces,
                           double most_filled) {
  return internal::Closer(vertices, faces).Close(most_filled);
}

Eigen::Matrix3Xd NormalsNear(const TriangleSurface& surface, const Eigen::Matrix3Xd& points) {
  Eigen::Matrix3Xd normals = Eigen::Matrix3Xd::Zero(3, surface.vertices.cols());
  for (const auto t : surface.triangles.colwise()) {
    const Eigen::Vector3d a = surface.vertices.col(t[0]);
    const Eigen::Vector3d b = surface.vertices.col(t[1]) - a, c = surface.vertices.col(t[2]) - a;
    const Eigen::Vector3d normal = b.cross(c);
    for (const int v : t) normals.col(v) += normal;
  }
  for (Eigen::Index v = 0; v < normals.cols(); ++v) normals.col(v).stableNormalize();
  const std::vector<int> nearest = NeighbourIndex(surface.vertices).Nearest(points, 1);
  Eigen::Matrix3Xd found(3, points.cols());
  for (Eigen::Index k = 0; k < points.cols(); ++k)
    found.col(k) = normals.col(nearest[std::size_t(k)]);
  return found;
}

}  // namespace batten
