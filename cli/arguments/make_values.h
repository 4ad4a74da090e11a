// SPDX-License-Identifier: MIT
// Values of the flags of `batten make` from their text. Each throws UsageError naming flag, text
// and rule.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "batten/geometry/frame.h"
#include "batten/geometry/nurbs_curve.h"
#include "cli/terminal/cli11_forward.h"

namespace batten::internal {

// A flag whose default is what its value holds; none is shown where that is empty.
CLI::Option* AddFlag(
    CLI::App& command, const char* flag, std::string& value, const char* type, const char* help);
void Require(
    CLI::App& command, const char* flag, std::string& value, const char* type, const char* help);

// Three numbers.
Eigen::Vector3d Triple(const char* flag, const std::string& text);

// Multiples of 90° become those of π/2 exactly.
double Radians(double degrees);

// The frame of --center, --axis and --x-axis; the last may be empty.
Frame ParseFrame(const std::string& center, const std::string& axis, const std::string& x_axis);

// The plane curve lifted into space: its x and y along these unit vectors.
NurbsCurve<3> Lifted(const NurbsCurve<2>& flat, const Eigen::Vector3d& x, const Eigen::Vector3d& y);

}  // namespace batten::internal
