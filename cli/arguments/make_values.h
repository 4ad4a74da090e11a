// SPDX-License-Identifier: MIT
// Flags of `batten make` and their values. What parses throws UsageError naming the flag.
#pragma once

#include <Eigen/Core>
#include <string>
#include <utility>
#include <vector>

#include "batten/geometry/frame.h"
#include "batten/geometry/nurbs_curve.h"
#include "cli/arguments/make_kind.h"
#include "cli/terminal/cli11_forward.h"

namespace batten::internal {

// A flag whose default is what its value holds; none is shown where that is empty.
CLI::Option* AddFlag(
    CLI::App& command, const char* flag, std::string& value, const char* type, const char* help);
void Require(
    CLI::App& command, const char* flag, std::string& value, const char* type, const char* help);

// The frame of --center, --axis and --x-axis; the last may be empty.
Frame ParseFrame(const std::string& center, const std::string& axis, const std::string& x_axis);

// These flags, and the frame they say.
void AddFrame(CLI::App& command, MakeArguments& a, const char* center, const char* axis);
Frame FrameOf(const MakeArguments& a);

Eigen::Vector3d Triple(const char* flag, const std::string& text);
std::pair<double, double> Pair(const char* flag, const std::string& text);
double Length(const char* flag, const std::string& text);  // positive

// `count` points of three numbers each, or of two: then z = 0.
Eigen::Matrix3Xd PointsOf(const char* flag, const std::string& text, int count);

// Multiples of 90° become those of π/2 exactly.
double Radians(double degrees);

AngleRange Angles(const char* start_flag,
                  const std::string& start,
                  const char* sweep_flag,
                  const std::string& sweep);
AngleRange AnglesOf(const MakeArguments& a);  // --start-angle, --sweep

// The plane curve lifted into space: its x and y along these unit vectors.
NurbsCurve<3> Lifted(const NurbsCurve<2>& flat, const Eigen::Vector3d& x, const Eigen::Vector3d& y);

}  // namespace batten::internal
