// SPDX-License-Identifier: MIT
// Curves from the files that name them.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "batten/geometry/nurbs_curve.h"
#include "cli/arguments/shared_unit.h"

namespace batten::internal {

// Where curves of the plane are put in space: their x and y along these.
struct Lifting {
  Eigen::Vector3d x = Eigen::Vector3d::UnitX(), y = Eigen::Vector3d::UnitY();
};

// All curves of the files in their order, in the unit they share; `format` is that of every file,
// empty: by its name. Throws UsageError where a file holds a surface, ReadError where it can't be
// read.
std::vector<NurbsCurve<3>> CurvesOf(const std::vector<std::string>& paths,
                                    const std::string& format,
                                    SharedUnit& unit,
                                    const Lifting& lifting = {});

// The same of one file that is to hold one curve, `what` of the command.
NurbsCurve<3> OnlyCurve(const std::string& path,
                        const std::string& format,
                        SharedUnit& unit,
                        const char* what,
                        const Lifting& lifting = {});

// The diagonal of the box of all control points.
double SizeOf(const std::vector<NurbsCurve<3>>& curves);

}  // namespace batten::internal
