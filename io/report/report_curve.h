// SPDX-License-Identifier: MIT
// Curves as a report shows them: samples with curvature. Not installed.
#pragma once

#include <vector>

#include "batten/geometry/nurbs_curve.h"
#include "batten/io/report_types.h"

namespace batten::internal {

// The axes in which curves are drawn flat, and whether they all lie in one plane along them.
struct Plan {
  Eigen::Vector3d u = Eigen::Vector3d::UnitX(), v = Eigen::Vector3d::UnitY();
  bool flat = true;

  Eigen::Vector3d normal() const;
};

// x and y where all lie across z; else the axis nearest to it where they lie across a coordinate
// axis, or the principal axes of the places, along which these reach farthest.
Plan PlanOf(const Eigen::Matrix3Xd& places);

// Everything but the name, of a curve near the origin: samples close enough to keep the chord
// tolerance (> 0) and turn by less than 3° from one to the next.
ReportCurve DrawCurve(const NurbsCurve<3>& curve, const Plan& plan, double chord_tolerance);

// Points of a curve, for PlanOf: a few of every span.
Eigen::Matrix3Xd CoarseSamples(const NurbsCurve<3>& curve);

}  // namespace batten::internal
