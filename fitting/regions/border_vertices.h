// SPDX-License-Identifier: MIT
// Corners of a part, where three faces and more meet.
#pragma once

#include <Eigen/Core>
#include <map>
#include <vector>

#include "fitting/regions/border_places.h"
#include "fitting/regions/border_walk.h"

namespace batten::internal {

struct BorderVertex {
  Eigen::Vector3d place;
  std::vector<int> faces;  // ascending, three or more
};

// Vertices nearer to one another than noise are one. Keeps references.
class BorderVertices {
 public:
  // Those near points that have points of three regions about them.
  BorderVertices(const FaceMeets& meets, const std::map<FacePair, BorderPlaces>& places);

  const std::vector<BorderVertex>& all() const { return all_; }

  // On both faces.
  std::vector<WalkEnd> On(const FacePair& faces) const;

  // Ends the border of two faces near a place: at the nearest corner with a third face that has
  // points near. False where there is none that is not known.
  bool EndAt(const FacePair& faces, const Eigen::Vector3d& place);

 private:
  bool Meet(int a, int b) const { return places_.contains(std::minmax(a, b)); }
  bool Add(const Eigen::Vector3d& place, const std::vector<int>& faces);

  const FaceMeets& meets_;
  const std::map<FacePair, BorderPlaces>& places_;
  std::vector<BorderVertex> all_;
};

}  // namespace batten::internal
