// SPDX-License-Identifier: MIT
// Places evenly over the faces of a solid of exact faces: what of it the points show, and how its
// shells lie to one another.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "batten/fitting/trimmed_solid.h"

namespace batten::internal {

// Pieces that an edge is cut into: a whole circle is off by half a percent, and neighbours are less
// than half a turn apart.
inline constexpr int kPiecesOfEdge = 32;

struct SolidSample {
  Eigen::Vector3d place, outward;
  double area = 0;  // for which it stands
  int face = 0;
};

// Cells of the carriers about `step` wide whose middles are on the left of the nearest piece of the
// faces' loops, or of any where there are none. Steps are longer where there would be more than
// some tens of thousands. O(samples · edges).
std::vector<SolidSample> SampledSolid(const TrimmedSolid& solid, double step);

// How a solid and its points cover one another. Near is twice the distance from the point to its
// sixth neighbour: 24 points are expected there where they lie evenly.
struct SolidCover {
  double invented = 0;  // of the area, the share without a point near
  double beside = 0;    // of the points, the share without a sample near, or in the next cell
};
SolidCover CoverOf(const std::vector<SolidSample>& samples, const Eigen::Matrix3Xd& points);

// The number of every face's shell, from 0.
std::vector<int> ShellsOf(const TrimmedSolid& solid);

// Whether a shell has samples inside another, by winding numbers. [Jacobson, Kavan & Sorkine-
// Hornung 2013]
bool ShellsInOneAnother(const std::vector<SolidSample>& samples, const std::vector<int>& shells);

}  // namespace batten::internal
