// SPDX-License-Identifier: MIT
#include "fitting/regions/face_borders.h"

#include <Eigen/Geometry>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>

#include "geometry/numeric/number_text.h"

namespace batten::internal {
namespace {

constexpr double kReach = 4;       // spacings: of a border from the points beside it
constexpr double kTangent = 0.14;  // sine: faces that meet under less have no sure border
constexpr int kFewLinks = 4;       // pairs of points: fewer are chance across a corner

class BorderFinder {
 public:
  BorderFinder(const RegionPoints& data,
               const RegionLabels& labels,
               const std::map<FacePair, FittedSurface>& contacts,
               double same)
      : data_(data), labels_(labels), contacts_(contacts), spacing_(data.spacing), same_(same) {}

  FaceBorders Find() && {
    FindPlaces();
    if (borders_.refused.empty()) FindVertices();
    for (const auto& [faces, places] : places_) {
      if (borders_.refused.empty()) FollowEdges(faces, places);
    }
    return std::move(borders_);
  }

 private:
  using Places = std::vector<Eigen::Vector3d>;

  const FittedSurface& Shape(int face) const { return labels_.regions[std::size_t(face)].shape; }
  // That cut one another in the border.
  std::vector<const FittedSurface*> Shapes(const FacePair& faces) const {
    const auto contact = contacts_.find(faces);
    return {&Shape(faces.first),
            contact == contacts_.end() ? &Shape(faces.second) : &contact->second};
  }

  // How far from a border its points may be: where faces touch, as far as noise hides one from the
  // other.
  double ReachOf(const FacePair& faces, const Eigen::Vector3d& near) const {
    constexpr double kAside = 0.01, kLargest = 0.2;  // of the size
    const FittedSurface here = Shape(faces.first).TouchingNear(near);
    const auto contact = contacts_.find(faces);
    const auto parted = [&](const Eigen::Vector3d& place, const Eigen::Vector3d& way) {
      const FittedSurface aside = Shape(faces.first).TouchingNear(place + kAside * way);
      return std::abs(Shape(faces.second).Distance(aside.point)) / (kAside * kAside);
    };
    double most = 0;  // the faces part by this times the distance squared
    if (contact != contacts_.end()) {
      const FittedSurface across = contact->second.TouchingNear(near);
      most = parted(across.point, across.normal);
    } else {
      most = std::max(parted(near, here.along), parted(near, here.Across()));
    }
    return kReach * spacing_ + std::min(kLargest, std::sqrt(same_ / most));
  }

  std::string At(const Eigen::Vector3d& place) const {
    const Eigen::Vector3d p = data_.unit * place + data_.middle;
    return "(" + RoundedText(p[0]) + ", " + RoundedText(p[1]) + ", " + RoundedText(p[2]) + ")";
  }
  static std::string Faces(const FacePair& faces) {
    return "faces " + std::to_string(faces.first) + " and " + std::to_string(faces.second);
  }

  std::optional<Eigen::Vector3d> PlaceIn(const FacePair& faces, const Eigen::Vector3d& near) const {
    const bool touch = contacts_.contains(faces);
    return PlaceOn(Shapes(faces), near, touch ? ReachOf(faces, near) : kReach * spacing_);
  }

  // Of every pair of faces whose points are neighbours.
  void FindPlaces() {
    std::map<FacePair, std::pair<int, Eigen::AlignedBox3d>> smooth;  // links without a place
    for (int k = 0; k < static_cast<int>(data_.size()); ++k) {
      const int here = labels_.label[std::size_t(k)];
      for (const int other : data_.Around(k)) {
        const int there = labels_.label[std::size_t(other)];
        if (other < k || here == there || here == kNoRegion || there == kNoRegion) continue;
        const FacePair faces = std::minmax(here, there);
        const Eigen::Vector3d middle = (data_.points.col(k) + data_.points.col(other)) / 2;
        if (const auto place = PlaceIn(faces, middle)) {
          places_[faces].push_back(*place);
        } else {
          auto& [count, where] = smooth[faces];
          ++count;
          where.extend(middle);
        }
      }
    }
    for (const auto& [faces, found] : smooth) {
      const auto& [count, where] = found;
      const auto sharp = places_.find(faces);
      const int places = sharp == places_.end() ? 0 : static_cast<int>(sharp->second.size());
      // Faces that touch at a point only are neighbours about it.
      const double wide = where.diagonal().norm();
      if (count <= std::max(kFewLinks, places) || wide <= 2 * ReachOf(faces, where.center()))
        continue;
      borders_.refused =
          Faces(faces) + " meet smoothly near " + At(where.center()) + ": points do not tell where";
      return;
    }
    std::erase_if(places_, [](const auto& one) { return std::ssize(one.second) < kFewLinks; });
  }

  // The regions of points within two rings.
  std::set<int> RegionsNear(int point) const {
    std::set<int> near;
    for (const int one : data_.Around(point)) {
      near.insert(labels_.label[std::size_t(one)]);
      for (const int two : data_.Around(one)) near.insert(labels_.label[std::size_t(two)]);
    }
    near.erase(kNoRegion);
    return near;
  }

  bool Meet(int a, int b) const { return places_.contains(std::minmax(a, b)); }

  void FindVertices() {
    for (int k = 0; k < static_cast<int>(data_.size()); ++k) {
      const std::set<int> near = RegionsNear(k);
      if (near.size() < 3) continue;
      for (auto a = near.begin(); a != near.end(); ++a) {
        for (auto b = std::next(a); b != near.end(); ++b) {
          for (auto c = std::next(b); c != near.end(); ++c) {
            if (Meet(*a, *b) + Meet(*b, *c) + Meet(*a, *c) < 2) continue;
            if (const auto place = Corner({*a, *b, *c}, data_.points.col(k)))
              AddVertex(*place, {*a, *b, *c});
          }
        }
      }
    }
  }

  // The place on three shapes, and on the curves along which some of them touch.
  std::optional<Eigen::Vector3d> Corner(const std::vector<int>& faces,
                                        const Eigen::Vector3d& near) const {
    std::vector<const FittedSurface*> shapes;
    double reach = kReach * spacing_;
    for (std::size_t i = 0; i < faces.size(); ++i) {
      shapes.push_back(&Shape(faces[i]));
      for (std::size_t j = 0; j < i; ++j) {
        const FacePair pair = std::minmax(faces[i], faces[j]);
        const auto contact = contacts_.find(pair);
        if (contact == contacts_.end()) continue;
        shapes.push_back(&contact->second);
        reach = std::max(reach, ReachOf(pair, near));
      }
    }
    return PlaceOn(shapes, near, reach);
  }

  void AddVertex(const Eigen::Vector3d& place, const std::vector<int>& faces) {
    for (BorderVertex& vertex : borders_.vertices) {
      if (!((vertex.place - place).norm() <= same_)) continue;
      vertex.faces.insert(vertex.faces.end(), faces.begin(), faces.end());
      std::sort(vertex.faces.begin(), vertex.faces.end());
      vertex.faces.erase(std::unique(vertex.faces.begin(), vertex.faces.end()), vertex.faces.end());
      return;
    }
    borders_.vertices.push_back({place, faces});
  }

  Eigen::Vector3d TangentAt(const FacePair& faces, const Eigen::Vector3d& place) const {
    const auto shapes = Shapes(faces);
    return shapes[0]
        ->TouchingNear(place)
        .normal.cross(shapes[1]->TouchingNear(place).normal)
        .stableNormalized();
  }

  // The nearest of the places, in spacings.
  double FarFrom(const Places& places, const Eigen::Vector3d& place) const {
    double least = std::numeric_limits<double>::infinity();
    for (const Eigen::Vector3d& one : places) least = std::min(least, (one - place).squaredNorm());
    return std::sqrt(least) / spacing_;
  }

  std::vector<int> VerticesOn(const FacePair& faces) const {
    std::vector<int> on;
    for (int k = 0; k < std::ssize(borders_.vertices); ++k) {
      const auto& of = borders_.vertices[std::size_t(k)].faces;
      if (std::binary_search(of.begin(), of.end(), faces.first) &&
          std::binary_search(of.begin(), of.end(), faces.second)) {
        on.push_back(k);
      }
    }
    return on;
  }

  // Whether places go on from a vertex in a direction.
  bool GoesOn(const Places& places, const Eigen::Vector3d& from, const Eigen::Vector3d& way) const {
    constexpr double kNear = 0.3, kFar = 3, kAhead = 0.7;
    return std::any_of(places.begin(), places.end(), [&](const Eigen::Vector3d& place) {
      const Eigen::Vector3d off = place - from;
      const double far = off.norm() / spacing_;
      return far > kNear && far < kFar && off.dot(way) > kAhead * off.norm();
    });
  }

  struct Walk {
    std::vector<Eigen::Vector3d> points;  // the first is where it began
    int end = -1;                         // the vertex it came to
    bool closed = false;
    Eigen::Vector3d way = Eigen::Vector3d::Zero();  // at its end
    std::string lost;                               // where it left the places
  };

  // Follows both shapes from a place until a vertex, or the place again.
  Walk Follow(const FacePair& faces,
              const Places& places,
              const std::vector<int>& vertices,
              const Eigen::Vector3d& from,
              Eigen::Vector3d way,
              int start) const {
    constexpr double kStep = 0.5, kShort = 1.0 / 64, kTurn = 0.15, kLost = 4, kPassed = 0.2;
    constexpr std::size_t kMost = 100000;
    Walk walk{{from}, -1, false, way, ""};
    double step = kStep * spacing_;
    while (walk.points.size() < kMost) {
      const Eigen::Vector3d here = walk.points.back();
      const auto next = PlaceOn(Shapes(faces), here + step * walk.way, step);
      Eigen::Vector3d turned = next ? TangentAt(faces, *next) : walk.way;
      if (turned.dot(walk.way) < 0) turned = -turned;
      if (!next || turned.cross(walk.way).norm() > kTurn) {
        step /= 2;
        if (step < kShort * spacing_) break;
        continue;
      }
      const Eigen::Vector3d ahead = *next - here;
      const auto passed = [&](const Eigen::Vector3d& place) {
        const double along = (place - here).dot(ahead) / ahead.squaredNorm();
        const double off = (place - here - along * ahead).norm();
        return along > 0 && along <= 1 && off <= kPassed * step;
      };
      const bool left = walk.points.size() > 2;
      for (const int vertex : vertices) {
        if ((vertex == start && !left) || !passed(borders_.vertices[std::size_t(vertex)].place))
          continue;
        walk.end = vertex;
        walk.way = turned;
        return walk;
      }
      if (start < 0 && left && passed(from)) {
        walk.closed = true;
        return walk;
      }
      walk.points.push_back(*next);
      walk.way = turned;
      step = std::min(kStep * spacing_, 1.5 * step);
      if (FarFrom(places, *next) > kLost) break;
    }
    walk.lost = At(walk.points.back());
    return walk;
  }

  // How many places are along a walk, away from the vertex where it began.
  int PlacesAlong(const Walk& walk, const Places& places, int start) const {
    constexpr double kBeside = 0.5;  // spacings
    const double away = BlurOf(borders_.vertices[std::size_t(start)]);
    return static_cast<int>(
        std::count_if(places.begin(), places.end(), [&](const Eigen::Vector3d& place) {
          return (place - walk.points.front()).norm() > away &&
                 FarFrom(walk.points, place) < kBeside;
        }));
  }

  // How far beyond a vertex points may be of its faces: where two of them touch, as far as noise
  // hides one from the other.
  double BlurOf(const BorderVertex& vertex) const {
    double blur = spacing_;
    for (const int a : vertex.faces) {
      for (const int b : vertex.faces) {
        if (a < b && contacts_.contains({a, b}))
          blur = std::max(blur, ReachOf({a, b}, vertex.place));
      }
    }
    return blur;
  }

  void FollowEdges(const FacePair& faces, const Places& places) {
    const std::vector<int> vertices = VerticesOn(faces);
    std::vector<std::pair<int, Eigen::Vector3d>> taken;  // directions at vertices
    const auto is_taken = [&](int vertex, const Eigen::Vector3d& way) {
      return std::any_of(taken.begin(), taken.end(), [&](const auto& one) {
        return one.first == vertex && one.second.dot(way) > 0;
      });
    };
    std::vector<Eigen::Vector3d> covered;
    const auto keep = [&](Walk walk, int start) {
      covered.insert(covered.end(), walk.points.begin(), walk.points.end());
      BorderEdge edge{faces, start, walk.end, {}};
      if (walk.end >= 0) walk.points.push_back(borders_.vertices[std::size_t(walk.end)].place);
      edge.points.resize(3, std::ssize(walk.points));
      for (std::size_t k = 0; k < walk.points.size(); ++k)
        edge.points.col(Eigen::Index(k)) = walk.points[k];
      borders_.edges.push_back(std::move(edge));
    };
    for (const int vertex : vertices) {
      const Eigen::Vector3d from = borders_.vertices[std::size_t(vertex)].place;
      covered.push_back(from);
      const Eigen::Vector3d tangent = TangentAt(faces, from);
      for (const Eigen::Vector3d& way : {tangent, Eigen::Vector3d(-tangent)}) {
        if (is_taken(vertex, way) || !GoesOn(places, from, way)) continue;
        Walk walk = Follow(faces, places, vertices, from, way, vertex);
        if (walk.end < 0 && PlacesAlong(walk, places, vertex) < kFewLinks)
          continue;  // chance at a corner
        if (walk.end < 0) {
          borders_.refused =
              "the border of " + Faces(faces) + " ends without a corner near " + walk.lost;
          return;
        }
        taken.emplace_back(vertex, way);
        taken.emplace_back(walk.end, -walk.way);
        keep(std::move(walk), vertex);
      }
    }
    constexpr double kCovered = 1.5;  // spacings
    for (const Eigen::Vector3d& place : places) {
      if (!covered.empty() && FarFrom(covered, place) <= kCovered) continue;
      const bool at_vertex = std::any_of(vertices.begin(), vertices.end(), [&](int k) {
        const BorderVertex& vertex = borders_.vertices[std::size_t(k)];
        return (vertex.place - place).norm() <= BlurOf(vertex);
      });
      if (at_vertex) continue;
      Walk walk = Follow(faces, places, vertices, place, TangentAt(faces, place), -1);
      if (!walk.closed) {
        borders_.refused = "the border of " + Faces(faces) +
                           " neither closes nor ends in corners near " + At(place);
        return;
      }
      keep(std::move(walk), -1);
    }
  }

  const RegionPoints& data_;
  const RegionLabels& labels_;
  const std::map<FacePair, FittedSurface>& contacts_;
  const double spacing_, same_;
  std::map<FacePair, Places> places_;
  FaceBorders borders_;
};

}  // namespace

std::optional<Eigen::Vector3d> PlaceOn(const std::vector<const FittedSurface*>& shapes,
                                       Eigen::Vector3d from,
                                       double reach) {
  constexpr int kSteps = 30;
  constexpr double kSettled = 1e-14;
  const Eigen::Vector3d start = from;
  const auto count = std::ssize(shapes);
  Eigen::MatrixXd normals(count, 3);
  Eigen::VectorXd off(count);
  double before = std::numeric_limits<double>::infinity();
  for (int step = 0; step < kSteps; ++step) {
    for (Eigen::Index k = 0; k < count; ++k) {
      const FittedSurface touching = shapes[std::size_t(k)]->TouchingNear(from);
      normals.row(k) = touching.normal.transpose();
      off[k] = shapes[std::size_t(k)]->Distance(from);
    }
    // The sine of an angle, and of three the volume, over which a step is divided.
    const bool many = count > 3;
    const Eigen::MatrixXd angles =
        many ? normals.transpose() * normals : Eigen::MatrixXd(normals * normals.transpose());
    if (!(std::sqrt(std::max(0.0, angles.determinant())) > kTangent)) return std::nullopt;
    const double far = off.norm();
    if (far <= kSettled || (far < 1e-11 && !(far < before / 2))) return from;
    before = far;
    if (many) {
      from -= angles.ldlt().solve(normals.transpose() * off);
    } else {
      from -= normals.transpose() * angles.ldlt().solve(off);
    }
    if (!((from - start).norm() <= reach)) return std::nullopt;
  }
  return before < 1e-9 ? std::optional(from) : std::nullopt;
}

FaceBorders FindBorders(const RegionPoints& data,
                        const RegionLabels& labels,
                        const std::map<FacePair, FittedSurface>& contacts,
                        double same) {
  return BorderFinder(data, labels, contacts, same).Find();
}

}  // namespace batten::internal
