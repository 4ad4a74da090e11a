// SPDX-License-Identifier: MIT
// Orthogonal distances of points to a curve from approximate foot parameters.
#pragma once

#include <Eigen/Core>

#include "batten/fitting/distances.h"

namespace batten::internal {

// Distances as DistancesTo gives them: from each point's nearest point on the whole curve, to 1e-11
// of its size. `starts` are parameters near the foot points, NaN where none is known. A local foot
// point that is provably the nearest is taken at once, several times as fast. The proof needs:
//  (1) |C − q|² is convex wherever the curve could be as near in the spans around, for a distance d
//      with d M₂ (1 + 2 M₁ / m₁) < m₁²; there m₁ ≤ C'·t for a direction t, |C'| ≤ M₁, |C''| ≤ M₂;
//  (2) what is not around is more than 2 d from the span of the foot.
template <int Dim>
PointDistances DistancesNear(const NurbsCurve<Dim>& curve,
                             const Eigen::Matrix3Xd& points,
                             const Eigen::VectorXd& starts,
                             ThreadPool& pool);

extern template PointDistances DistancesNear<2>(const NurbsCurve<2>&,
                                                const Eigen::Matrix3Xd&,
                                                const Eigen::VectorXd&,
                                                ThreadPool&);
extern template PointDistances DistancesNear<3>(const NurbsCurve<3>&,
                                                const Eigen::Matrix3Xd&,
                                                const Eigen::VectorXd&,
                                                ThreadPool&);

}  // namespace batten::internal
