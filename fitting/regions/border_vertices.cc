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
            Add(*place, {*a, *b, *c});
        }
      }
    }
  }
}

std::vector<WalkEnd> BorderVertices::On(const FacePair& faces) const {
  std::vector<WalkEnd> on;
  for (int k = 0; k < std::ssize(all_); ++k) {
    const auto& [place, of] = all_[std::size_t(k)];
    if (std::binary_search(of.begin(), of.end(), faces.first) &&
        std::binary_search(of.begin(), of.end(), faces.second)) {
      on.push_back({k, place, meets_.BlurOf(of, place)});
    }
  }
  return on;
}

bool BorderVertices::EndAt(const FacePair& faces, const Eigen::Vector3d& place) {
  constexpr double kNear = 4;  // spacings
  const auto [a, b] = faces;
  const double reach = std::max(kNear * meets_.spacing(), meets_.BlurOf({a, b}, place));
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
    nearest = {*corner, std::move(of)};
  }
  return !nearest.faces.empty() && Add(nearest.place, nearest.faces);
}

// Whether there is a vertex more, or one of more faces.
bool BorderVertices::Add(const Eigen::Vector3d& place, const std::vector<int>& faces) {
  for (BorderVertex& vertex : all_) {
    if (!((vertex.place - place).norm() <= meets_.same())) continue;
    std::set<int> joined(vertex.faces.begin(), vertex.faces.end());
    joined.insert(faces.begin(), faces.end());
    const bool more = joined.size() > vertex.faces.size();
    vertex.faces.assign(joined.begin(), joined.end());
    return more;
  }
  all_.push_back({place, faces});
  return true;
}

}  // namespace batten::internal
