// SPDX-License-Identifier: MIT
#include "fitting/regions/border_vertices.h"

#include <algorithm>
#include <limits>
#include <set>
#include <utility>

namespace batten::internal {
namespace {

// The regions of points within two rings.
std::vector<int> RegionsNear(const FaceMeets& meets, int point) {
  std::set<int> near;
  for (const int one : meets.data().Around(point)) {
    near.insert(meets.LabelOf(one));
    for (const int two : meets.data().Around(one)) near.insert(meets.LabelOf(two));
  }
  near.erase(kNoRegion);
  return {near.begin(), near.end()};
}

}  // namespace

BorderVertices::BorderVertices(const FaceMeets& meets,
                               const std::map<FacePair, BorderPlaces>& places)
    : meets_(meets), places_(places) {
  for (int k = 0; k < static_cast<int>(meets_.data().size()); ++k) {
    const std::vector<int> near = RegionsNear(meets_, k);
    if (near.size() < 3) continue;
    for (auto a = near.begin(); a != near.end(); ++a) {
      for (auto b = std::next(a); b != near.end(); ++b) {
        for (auto c = std::next(b); c != near.end(); ++c) {
          if (Meet(*a, *b) + Meet(*b, *c) + Meet(*a, *c) < 2) continue;
          if (const auto place = meets_.Corner({*a, *b, *c}, meets_.data().points.col(k)))
            Add(*place, WithTangent({*a, *b, *c}, near, *place), false);
        }
      }
    }
  }
}

std::vector<int> BorderVertices::WithTangent(std::vector<int> faces,
                                             const std::vector<int>& near,
                                             const Eigen::Vector3d& place) const {
  const std::vector<int> corner = faces;
  for (const int face : near) {
    if (std::binary_search(corner.begin(), corner.end(), face)) continue;
    const bool touches = std::any_of(corner.begin(), corner.end(), [&](int other) {
      return meets_.SineAt(std::minmax(face, other), place) < kTangent;
    });
    if (touches && meets_.IsOn(face, place)) faces.push_back(face);
  }
  std::sort(faces.begin(), faces.end());
  return faces;
}

std::vector<WalkEnd> BorderVertices::On(const FacePair& faces) const {
  std::vector<WalkEnd> on;
  for (int k = 0; k < std::ssize(all_); ++k) {
    const auto& [place, of, ends_lost] = all_[std::size_t(k)];
    if (std::binary_search(of.begin(), of.end(), faces.first) &&
        std::binary_search(of.begin(), of.end(), faces.second)) {
      const double blur = meets_.BlurOf(of, place);
      on.push_back({k,
                    place,
                    blur,
                    ends_lost ? std::numeric_limits<double>::infinity() : blur,
                    meets_.SineAt(faces, place) < kTangent});
    }
  }
  return on;
}

bool BorderVertices::End(const std::vector<LooseEnd>& ends) {
  std::vector<LooseEnd> left;
  for (const LooseEnd& end : ends) {
    if (!EndAt(end)) left.push_back(end);
  }
  bool added = left.size() < ends.size();
  // The two nearest first.
  std::vector<std::pair<double, std::pair<std::size_t, std::size_t>>> pairs;
  for (std::size_t i = 0; i < left.size(); ++i) {
    for (std::size_t j = i + 1; j < left.size(); ++j)
      pairs.push_back({(left[i].place - left[j].place).norm(), {i, j}});
  }
  std::sort(pairs.begin(), pairs.end());
  std::vector<bool> ended(left.size());
  for (const auto& [apart, pair] : pairs) {
    const auto [i, j] = pair;
    if (ended[i] || ended[j] || !EndBoth(left[i], left[j])) continue;
    ended[i] = ended[j] = added = true;
  }
  return added;
}

// Two borders that share one face end where all three meet, however far their points are from it.
bool BorderVertices::EndBoth(const LooseEnd& one, const LooseEnd& other) {
  std::set<int> faces{one.faces.first, one.faces.second, other.faces.first, other.faces.second};
  if (faces.size() != 3) return false;
  const std::vector<int> of(faces.begin(), faces.end());
  const Eigen::Vector3d middle = (one.place + other.place) / 2;
  const double apart = (one.place - other.place).norm();
  const auto corner = meets_.Corner(of, middle, apart);
  const auto ahead = [&](const LooseEnd& end) { return (*corner - end.place).dot(end.way) > 0; };
  return corner && ahead(one) && ahead(other) && Add(*corner, of, true);
}

bool BorderVertices::EndAt(const LooseEnd& end) {
  const auto [a, b] = end.faces;
  const Eigen::Vector3d& place = end.place;
  const double reach = std::max(kBorderReach * meets_.spacing(), meets_.BlurOf({a, b}, place));
  const RegionPoints& data = meets_.data();
  std::set<int> thirds;
  for (int k = 0; k < static_cast<int>(data.size()); ++k) {
    const int face = meets_.LabelOf(k);
    if (face == kNoRegion || face == a || face == b || !(Meet(a, face) || Meet(b, face))) continue;
    if ((data.points.col(k) - place).norm() <= reach) thirds.insert(face);
  }
  double least = std::numeric_limits<double>::infinity();
  BorderVertex nearest;
  for (const int third : thirds) {
    std::vector<int> of{a, b, third};
    std::sort(of.begin(), of.end());
    const auto corner = meets_.Corner(of, place);
    if (!corner || !((*corner - place).norm() < least)) continue;
    least = (*corner - place).norm();
    nearest = {*corner, std::move(of), true};
  }
  return !nearest.faces.empty() && Add(nearest.place, nearest.faces, true);
}

// Whether there is a vertex more, or one of more faces.
bool BorderVertices::Add(const Eigen::Vector3d& place,
                         const std::vector<int>& faces,
                         bool ends_lost) {
  for (BorderVertex& vertex : all_) {
    if (!((vertex.place - place).norm() <= meets_.same())) continue;
    std::set<int> joined(vertex.faces.begin(), vertex.faces.end());
    joined.insert(faces.begin(), faces.end());
    const bool more = joined.size() > vertex.faces.size() || (ends_lost && !vertex.ends_lost);
    vertex.ends_lost = vertex.ends_lost || ends_lost;
    vertex.faces.assign(joined.begin(), joined.end());
    return more;
  }
  all_.push_back({place, faces, ends_lost});
  return true;
}

}  // namespace batten::internal
