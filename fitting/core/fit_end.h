// SPDX-License-Identifier: MIT
// The one place that decides how a fit ended, and says it.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

#include "batten/fitting/fit_report.h"

namespace batten::internal {

// What is known of a fit's residuals when it ends.
struct EndEvidence {
  // How the search for degrees of freedom ended: tolerance_reached, noise_reached (what is out is
  // noise), cross_validated, detail_below_spacing, max_control_points or cancelled.
  EndCode search = EndCode::kCrossValidated;
  bool control_points_given = false;
  double noise = 0;         // standard deviation across the shape; 0: unknown
  double rounding = 0;      // residuals below are rounding of the coordinates
  bool structured = false;  // neighbouring residuals have a shape in common
  std::optional<Eigen::Vector3d> farthest = std::nullopt;  // the used point farthest off, world
};

// Decides by the measured errors of the report, which are against its tolerance if there is one:
//  · cancelled as the search was;
//  · structured_residuals if the surface or curve leaves its points, with the place where it does
//  most; · tolerance_reached if no point is out; · noise_reached if the rms is at most twice the
//  noise or rounding, or the search found what is
//    out to be noise, unless control points ran out first;
//  · max_control_points if the limit, or the number asked for, stopped the search;
//  · structured_residuals if neighbours share what is left: the shape goes on beyond the fit;
//  · else as the search ended: cross_validated, or detail_below_spacing.
// Sets `end` and `termination`.
void JudgeEnd(const EndEvidence& evidence, FitReport& report);

// By how much the shape leaves its points, or their box. The report has an overshoot and the kind
// of the geometry.
std::string WordsOfLeaving(const FitReport& report);

}  // namespace batten::internal
