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
  bool ends_lost = false;  // made to end a border that was lost: the others of its faces end too
};

// Where a border is lost, and which way it went on.
struct LooseEnd {
  FacePair faces;
  Eigen::Vector3d place, way;
};

// Vertices nearer to one another than noise are one. Keeps references.
class BorderVertices {
 public:
  // Those near points that have points of three regions about them.
  BorderVertices(const FaceMeets& meets, const std::map<FacePair, BorderPlaces>& places);

  const std::vector<BorderVertex>& all() const { return all_; }

  // On both faces.
  std::vector<WalkEnd> On(const FacePair& faces) const;

  // Ends lost borders: each at the nearest corner with a third face that has points near, or two of
  // three faces where these meet ahead of both. False where there is no corner that is not known.
  bool End(const std::vector<LooseEnd>& ends);

 private:
  bool Meet(int a, int b) const { return places_.contains(std::minmax(a, b)); }
  // A corner's faces and those near it that pass it in the tangent plane of one of them: no three
  // with these tell where it is.
  std::vector<int> WithTangent(std::vector<int> faces,
                               const std::vector<int>& near,
                               const Eigen::Vector3d& place) const;
  bool EndAt(const LooseEnd& end);
  bool EndBoth(const LooseEnd& one, const LooseEnd& other);
  bool Add(const Eigen::Vector3d& place, const std::vector<int>& faces, bool ends_lost);

  const FaceMeets& meets_;
  const std::map<FacePair, BorderPlaces>& places_;
  std::vector<BorderVertex> all_;
};

}  // namespace batten::internal
