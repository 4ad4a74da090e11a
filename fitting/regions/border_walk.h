// SPDX-License-Identifier: MIT
// Follows the border of two faces along the places that points show.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "fitting/regions/face_meets.h"

namespace batten::internal {

using BorderPlaces = std::vector<Eigen::Vector3d>;

inline Eigen::Matrix3Xd AsColumns(const BorderPlaces& places) {
  return Eigen::Map<const Eigen::Matrix3Xd>(places.data()->data(), 3, std::ssize(places));
}

// The distance of the nearest of the places.
double FarFrom(const BorderPlaces& places, const Eigen::Vector3d& place);

// Where a walk may end.
struct WalkEnd {
  int vertex = -1;
  Eigen::Vector3d place = Eigen::Vector3d::Zero();
  double blur = 0;     // how far before and beyond it points may be of other faces
  double reach = 0;    // how far from it a border that leads to it may have lost its points
  bool fades = false;  // the two faces are near to tangent there
};

struct BorderWalk {
  BorderPlaces points;  // the first is where it began
  int end = -1;         // the vertex it came to
  bool closed = false;
  Eigen::Vector3d way = Eigen::Vector3d::Zero();   // at its end
  Eigen::Vector3d seen = Eigen::Vector3d::Zero();  // the last of its points that has places beside
};

// Along both shapes from a place on them until one of the ends; from a place that is no vertex
// (`start` −1) until that place again, or from a vertex until any other, or itself once round.
// Lost, with neither, where it has left the places behind and no end that reaches as far is ahead.
// Where the faces fade into one another at an end, it is the last piece, along which noise hides
// where they meet, that goes straight there.
BorderWalk FollowBorder(const FaceMeets& meets,
                        const FacePair& faces,
                        const BorderPlaces& places,
                        const std::vector<WalkEnd>& ends,
                        const Eigen::Vector3d& from,
                        const Eigen::Vector3d& way,
                        int start);

}  // namespace batten::internal
