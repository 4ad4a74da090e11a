// SPDX-License-Identifier: MIT
#include "fitting/regions/border_places.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <utility>

namespace batten::internal {

FoundPlaces FindPlaces(const FaceMeets& meets) {
  FoundPlaces found;
  std::map<FacePair, std::pair<int, Eigen::AlignedBox3d>> smooth;  // links without a place
  std::map<FacePair, std::pair<int, int>> reached;  // links whose points are at the place, by face
  const RegionPoints& data = meets.data();
  for (int k = 0; k < static_cast<int>(data.size()); ++k) {
    const int here = meets.LabelOf(k);
    for (const int other : data.Around(k)) {
      const int there = meets.LabelOf(other);
      if (other < k || here == there || here == kNoRegion || there == kNoRegion) continue;
      const FacePair faces = std::minmax(here, there);
      const Eigen::Vector3d middle = (data.points.col(k) + data.points.col(other)) / 2;
      if (const auto place = meets.PlaceIn(faces, middle)) {
        found.of[faces].push_back(*place);
        const double reach = meets.BesideOf(faces, *place);
        auto& [first, second] = reached[faces];
        first += (data.points.col(here == faces.first ? k : other) - *place).norm() <= reach;
        second += (data.points.col(here == faces.first ? other : k) - *place).norm() <= reach;
      } else if (meets.BothAt(faces, middle)) {
        auto& [count, where] = smooth[faces];
        ++count;
        where.extend(middle);
      }
    }
  }
  for (const auto& [faces, links] : smooth) {
    const auto& [count, where] = links;
    const auto sharp = found.of.find(faces);
    const int places = sharp == found.of.end() ? 0 : static_cast<int>(sharp->second.size());
    // Faces that touch at a point only are neighbours about it.
    const double wide = where.diagonal().norm();
    if (count <= std::max(kFewLinks, places) || wide <= 2 * meets.ReachOf(faces, where.center()))
      continue;
    found.refused = WordsOf(faces) + " meet smoothly near " + meets.At(where.center()) +
                    ": points do not tell where";
    return found;
  }
  // Faces on two sides of a thin wall are neighbours, and their shapes may meet near it.
  std::erase_if(found.of, [&](const auto& one) {
    const auto [first, second] = reached.at(one.first);
    return std::min(first, second) < kFewLinks;
  });
  return found;
}

std::string WordsOf(const FacePair& faces) {
  return "faces " + std::to_string(faces.first) + " and " + std::to_string(faces.second);
}

}  // namespace batten::internal
