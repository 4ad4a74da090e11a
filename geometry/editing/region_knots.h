// SPDX-License-Identifier: MIT
// Knots and functions of a region of the domain that is changed.
#pragma once

#include <string>
#include <vector>

#include "batten/geometry/parameter_range.h"
#include "batten/geometry/spline_basis.h"

namespace batten::internal {

// Throws std::invalid_argument unless the range is finite, not empty and inside the domain;
// `function` and `name` ("u") are the first words.
void CheckRange(const SplineBasis& basis,
                const ParameterRange& range,
                const std::string& function,
                const std::string& name);

// The values to insert so that each of `wanted` is a knot, to 1e-9 of `length`: those that have
// none so near. Values outside the domain are wrapped where it goes `round`, left out elsewhere.
std::vector<double> LackingKnots(const SplineBasis& basis,
                                 std::vector<double> wanted,
                                 double length,
                                 bool round);

// The ends of the range, and `spans` − 1 places between them.
std::vector<double> EvenPlaces(const ParameterRange& range, int spans);

// Of each distinct control point, the share of the range at which it acts most (its Greville
// abscissa), where it acts nowhere outside; −1 elsewhere.
std::vector<double> SharesInside(const SplineBasis& basis, const ParameterRange& range);

// Which distinct control points act somewhere inside the range.
std::vector<bool> ActingInside(const SplineBasis& basis, const ParameterRange& range);

}  // namespace batten::internal
