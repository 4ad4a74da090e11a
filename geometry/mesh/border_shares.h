// SPDX-License-Identifier: MIT
// Where the border of a face is divided to begin with. Internal to geometry.
#pragma once

#include <vector>

#include "batten/geometry/nurbs_curve.h"
#include "geometry/mesh/domain_mesh.h"

namespace batten::internal {

// Shares of the curve's domain, increasing from 0 to 1: those of EdgeParameters, those where it
// crosses creases, and one at least inside where it is bent in space, three where it closes there.
std::vector<double> BorderShares(const NurbsCurve<2>& curve,
                                 const DomainMesh& mesh,
                                 double tolerance,
                                 double beside);

// Sorted, without those that are next to none apart.
void SortShares(std::vector<double>& shares);

// The place at a share of the curve's domain.
Eigen::Vector2d AtShare(const NurbsCurve<2>& curve, double share);

}  // namespace batten::internal
