// SPDX-License-Identifier: MIT
// Parameters of a fitted surface (axis, centre, radii, angles) with their standard deviations.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "batten/fitting/fit_report.h"
#include "fitting/primitives/shape_fitter.h"

namespace batten::internal {

// Lengths in the data's units, angles in radians. Names are, by kind:
//   plane     offset, normal_x, normal_y
//   sphere    center_x, center_y, center_z, radius
//   cylinder  axis_x, axis_y, point_x, point_y, radius
//   cone      axis_x, axis_y, apex_x, apex_y, apex_z, half_angle
//   torus     axis_x, axis_y, center_x, center_y, center_z, major_radius, minor_radius
// axis_x and axis_y (normal_x and normal_y) are turns of the axis towards frame_x and frame_y,
// point_x and point_y shifts of the axis that way beside the middle of the points, the offset is
// that of the plane along its normal there; their values are zero. Other _x, _y, _z are along the
// coordinate axes.
// Three standard deviations reach as far as the numbers go while the freedoms stay within three of
// theirs: for a short arc farther than the covariance says. The inflation is the least over all
// directions; 1 without correlation.
struct ShapeEstimate : PrimitiveAccuracy {
  Eigen::VectorXd values;
  // Sentences for the user on what the points do not determine.
  std::vector<std::string> warnings;
};

// Standard deviations above these shares of a length, and angles, tell that points do not determine
// it.
inline constexpr double kVague = 1.0 / 3, kVagueAngle = 0.2;

// σ² (Σ w ∇d ∇dᵀ)⁻¹ carried over from the freedoms to the numbers; with a loss, the factor of an
// M-estimate. Where the sums of w d ∇d over blocks of neighbours, of 1/16, 1/8 or 1/4 of the size,
// are larger than independent noise makes them, the variances are those of the blocks: the
// sandwich; where the widest are larger than the next, by as much more again. Distances below
// `rounding` (of the fitter's unit) count as that large. [Huber 1981, §7.6; White 1980; Liang &
// Zeger 1986] O(m).
ShapeEstimate EstimateOf(const ShapeFit& fit,
                         ShapeFitter& fitter,
                         double rounding,
                         ThreadPool& pool);

}  // namespace batten::internal
