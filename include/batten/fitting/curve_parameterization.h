// SPDX-License-Identifier: MIT
// Parameters for the points of a curve, from where the points lie.
#pragma once

#include <Eigen/Core>

#include "batten/fitting/curve_options.h"

namespace batten {

// The word reports use, as in "chord".
const char* Name(CurveParameterization parameterization);

// The parameters of points (d × m) in the order of the curve, on [0, 1], never decreasing.
// Neighbours in the same place get equal parameters, except from kUniform and kUniversal, which do
// not look. A closed curve goes on from the last point to the first: m + 1 values, of which the
// last, 1, is the first point's again. The degree counts for kUniversal only; closed, its maxima
// are uniform.
// Scaling the points by any factor changes nothing beyond rounding. O(m·d²).
// Throws std::invalid_argument for kGiven, fewer than two points, points that are not finite or all
// in one place (where places count), and kUniversal with not more points than the degree.
// [Piegl & Tiller 1997, §9.2.1]
Eigen::VectorXd CurveParameters(const Eigen::Ref<const Eigen::MatrixXd>& points,
                                CurveParameterization parameterization,
                                int degree = 3,
                                bool closed = false);

// The cloud with the x-coordinates (world) as parameters u: of a function y(x).
PointCloud ParameterizedByX(PointCloud cloud);

}  // namespace batten
