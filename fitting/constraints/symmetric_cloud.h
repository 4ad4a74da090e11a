// SPDX-License-Identifier: MIT
// Clouds completed by their mirror image, and parameterizations symmetric under the reflection.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "batten/fitting/mirror_plane.h"
#include "batten/fitting/point_cloud.h"
#include "batten/fitting/point_mask.h"
#include "batten/geometry/direction.h"
#include "fitting/parameterization/parameterization.h"

namespace batten::internal {

// The points followed by their mirror images; a point that is its own image occurs once. Weights,
// colours and (mirrored) normals go along, given parameters do not.
struct SymmetricCloud {
  PointCloud cloud;
  std::vector<Eigen::Index> twins;  // for every point, the index of its image
};

// Adds the mirror images in a plane given in world coordinates. Throws std::invalid_argument unless
// its normal has length one (to 1e-9; it is then normalised) and all values are finite.
SymmetricCloud WithMirrorImage(const PointCloud& cloud, const MirrorPlane& plane);

// A base under which the mirror image of the point at (u, v) is at (length_u − u, v) or at
// (u, length_v − v), with or without full turns in a periodic direction: for every pair of twins to
// rounding of the lengths.
struct SymmetricBase {
  Parameterization base;
  Direction reflected = Direction::kU;
};

// Makes a base symmetric for a cloud that is its own mirror image in the plane (in the cloud's
// coordinates, relative to its origin), with twins given; points outside the mask may have any
// parameters. A plane base is turned until its normal lies in the mirror plane. For other bases the
// parameters of twins must be related by a reflection of the parameter plane or of a circle to
// within a twentieth of the lengths; the frame is turned so that it reflects u or v, and each point
// gets the mean of its own parameters and its twin's reflected ones. Throws std::invalid_argument,
// with a sentence for the user, where there is no such reflection: the image lies over the cloud as
// a second layer, there is a gap between the two as wide as either, or the parameters are related
// otherwise.
SymmetricBase SymmetricParameters(const Parameterization& base,
                                  const PointCloud& cloud,
                                  const PointMask& mask,
                                  const MirrorPlane& plane,
                                  const std::vector<Eigen::Index>& twins);

}  // namespace batten::internal
