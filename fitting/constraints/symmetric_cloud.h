// SPDX-License-Identifier: MIT
// Clouds completed by their mirror image, and parameters that know of it.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "batten/fitting/mirror_plane.h"
#include "batten/fitting/point_cloud.h"
#include "batten/fitting/point_mask.h"
#include "batten/geometry/direction.h"
#include "fitting/parameterization/parameterization.h"

namespace batten::internal {

// The points and, behind them, their mirror images; a point whose image is itself stands once.
// Weights, colours and (mirrored) normals go along, given parameters do not.
struct SymmetricCloud {
  PointCloud cloud;
  std::vector<Eigen::Index> twins;  // of every point the index of its image
};

// The plane in world coordinates. Throws std::invalid_argument unless its normal has length one (to
// 1e-9, and is then made so) and all is finite.
SymmetricCloud WithMirrorImage(const PointCloud& cloud, const MirrorPlane& plane);

// A base under which the mirror image of the point at (u, v) is at (length_u − u, v) or at
// (u, length_v − v), with or without full turns in a periodic direction: for every pair of twins to
// rounding of the lengths.
struct SymmetricBase {
  Parameterization base;
  Direction reflected = Direction::kU;
};

// From any base of a cloud that is its own mirror image in the plane (in the cloud's coordinates,
// relative to its origin), with twins given; points outside the mask may have any parameters. A
// plane base is turned upright in the mirror plane. Else the parameters of twins must be related by
// a reflection of the parameter plane or of a circle to within a twentieth of the lengths; the
// frame is turned so that it reflects u or v, and each point takes the mean of its own parameters
// and those its twin stands for. Throws std::invalid_argument, with a sentence for the user, where
// there is no such reflection: the image lies over the cloud as a second layer, there is a gap
// between the two as wide as either, or the parameters are related by something else.
SymmetricBase SymmetricParameters(const Parameterization& base,
                                  const PointCloud& cloud,
                                  const PointMask& mask,
                                  const MirrorPlane& plane,
                                  const std::vector<Eigen::Index>& twins);

}  // namespace batten::internal
