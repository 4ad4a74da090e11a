// SPDX-License-Identifier: MIT
// The curve through the places of a border.
#pragma once

#include <Eigen/Core>

#include "batten/fitting/trimmed_solid.h"
#include "fitting/regions/face_borders.h"

namespace batten::internal {

// Whether all points are on the segment from the first to the last.
bool OnSegment(const Eigen::Matrix3Xd& points);

// The segment or the arc that the places of the edge are on, else a cubic curve through them,
// mapped by x → scale · x + shift. Its vertices are not set.
TrimmedSolidEdge CurveOf(const BorderEdge& edge, double scale, const Eigen::Vector3d& shift);

}  // namespace batten::internal
