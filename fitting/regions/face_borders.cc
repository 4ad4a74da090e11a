// SPDX-License-Identifier: MIT
#include "fitting/regions/face_borders.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

#include "fitting/regions/border_places.h"

namespace batten::internal {
namespace {

class BorderFinder {
 public:
  explicit BorderFinder(const FaceMeets& meets) : meets_(meets), spacing_(meets.spacing()) {}

  FaceBorders Find() && {
    FoundPlaces found = FindPlaces(meets_);
    borders_.refused = std::move(found.refused);
    if (!borders_.refused.empty()) return std::move(borders_);
    places_ = std::move(found.of);
    BorderVertices vertices(meets_, places_);
    vertices_ = &vertices;
    constexpr int kMostRounds = 16;  // each finds a corner more
    for (int round = 0;; ++round) {
      borders_.edges.clear();
      loose_.clear();
      for (const auto& [faces, places] : places_) FollowEdges(faces, places);
      if (round < kMostRounds && vertices.End(loose_)) continue;
      if (!loose_.empty()) {
        borders_.refused = "the border of " + WordsOf(loose_[0].faces) +
                           " ends without a corner near " + meets_.At(loose_[0].place);
      }
      borders_.vertices = vertices.all();
      return std::move(borders_);
    }
  }

 private:
  // Whether places go on from a vertex in a direction.
  bool GoesOn(const BorderPlaces& places,
              const Eigen::Vector3d& from,
              const Eigen::Vector3d& way) const {
    constexpr double kNear = 0.3, kFar = 3, kAhead = 0.7;
    return std::any_of(places.begin(), places.end(), [&](const Eigen::Vector3d& place) {
      const Eigen::Vector3d off = place - from;
      const double far = off.norm() / spacing_;
      return far > kNear && far < kFar && off.dot(way) > kAhead * off.norm();
    });
  }

  // How many places are along a walk, away from vertices as far as these blur.
  int PlacesAlong(const BorderWalk& walk,
                  const BorderPlaces& places,
                  const std::vector<WalkEnd>& vertices) const {
    constexpr double kBeside = 0.5;  // spacings
    return static_cast<int>(
        std::count_if(places.begin(), places.end(), [&](const Eigen::Vector3d& place) {
          const bool hidden = std::any_of(vertices.begin(), vertices.end(), [&](const auto& at) {
            return (place - at.place).norm() <= at.blur;
          });
          return !hidden && FarFrom(walk.points, place) < kBeside * spacing_;
        }));
  }

  void Keep(const FacePair& faces, BorderWalk walk, int start, int shown) {
    if (walk.end >= 0) walk.points.push_back(vertices_->all()[std::size_t(walk.end)].place);
    borders_.edges.push_back({faces, start, walk.end, AsColumns(walk.points), shown});
  }

  void FollowEdges(const FacePair& faces, const BorderPlaces& places) {
    const std::vector<WalkEnd> vertices = vertices_->On(faces);
    std::vector<std::pair<int, Eigen::Vector3d>> taken;  // directions at vertices
    const auto is_taken = [&](int vertex, const Eigen::Vector3d& way) {
      return std::any_of(taken.begin(), taken.end(), [&](const auto& one) {
        return one.first == vertex && one.second.dot(way) > 0;
      });
    };
    BorderPlaces covered;
    const auto cover = [&](const BorderWalk& walk) {
      covered.insert(covered.end(), walk.points.begin(), walk.points.end());
    };
    for (const WalkEnd& vertex : vertices) {
      covered.push_back(vertex.place);
      const Eigen::Vector3d tangent = meets_.TangentAt(faces, vertex.place);
      for (const Eigen::Vector3d& way : {tangent, Eigen::Vector3d(-tangent)}) {
        if (is_taken(vertex.vertex, way) || !GoesOn(places, vertex.place, way)) continue;
        BorderWalk walk =
            FollowBorder(meets_, faces, places, vertices, vertex.place, way, vertex.vertex);
        const int shown = PlacesAlong(walk, places, vertices);
        if (walk.end < 0 && shown < kFewLinks) continue;  // chance at a corner
        cover(walk);
        if (walk.end < 0) {
          loose_.push_back({faces, walk.seen, walk.way});
          continue;
        }
        taken.emplace_back(vertex.vertex, way);
        taken.emplace_back(walk.end, -walk.way);
        Keep(faces, std::move(walk), vertex.vertex, shown);
      }
    }
    constexpr double kCovered = 1.5;  // spacings
    for (const Eigen::Vector3d& place : places) {
      if (FarFrom(covered, place) <= kCovered * spacing_) continue;
      const bool at_vertex = std::any_of(vertices.begin(), vertices.end(), [&](const WalkEnd& at) {
        return (at.place - place).norm() <= at.blur;
      });
      if (at_vertex) continue;
      const Eigen::Vector3d way = meets_.TangentAt(faces, place);
      BorderWalk walk = FollowBorder(meets_, faces, places, vertices, place, way, -1);
      cover(walk);
      if (walk.closed) {
        const int shown = PlacesAlong(walk, places, vertices);
        Keep(faces, std::move(walk), -1, shown);
        continue;
      }
      BorderWalk back = FollowBorder(meets_, faces, places, vertices, place, -way, -1);
      cover(back);
      const int shown = PlacesAlong(walk, places, vertices) + PlacesAlong(back, places, vertices);
      if (shown < 2 * kFewLinks) continue;  // chance: the first place counts twice
      const bool ends = walk.end >= 0 && back.end >= 0;
      if (ends && !is_taken(walk.end, -walk.way) && !is_taken(back.end, -back.way)) {
        // A gap among the places hid it from its corners.
        taken.emplace_back(walk.end, -walk.way);
        taken.emplace_back(back.end, -back.way);
        Keep(faces, Joined(back, walk), back.end, shown);
        continue;
      }
      if (walk.end < 0) loose_.push_back({faces, walk.seen, walk.way});
      if (back.end < 0) loose_.push_back({faces, back.seen, back.way});
      if (ends) loose_.push_back({faces, place, way});
    }
  }

  // From the end of one walk to that of another that began where it did, the other way.
  BorderWalk Joined(const BorderWalk& back, const BorderWalk& walk) const {
    BorderWalk joined = walk;
    joined.points.assign(back.points.rbegin(), back.points.rend());
    joined.points.front() = vertices_->all()[std::size_t(back.end)].place;
    joined.points.insert(joined.points.end(), walk.points.begin() + 1, walk.points.end());
    return joined;
  }

  const FaceMeets& meets_;
  const double spacing_;
  std::map<FacePair, BorderPlaces> places_;
  BorderVertices* vertices_ = nullptr;
  std::vector<LooseEnd> loose_;
  FaceBorders borders_;
};

}  // namespace

FaceBorders FindBorders(const FaceMeets& meets) { return BorderFinder(meets).Find(); }

}  // namespace batten::internal
