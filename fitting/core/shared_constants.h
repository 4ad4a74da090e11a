// SPDX-License-Identifier: MIT
// Constants that several rooms share.
#pragma once

namespace batten::internal {

// Tukey's loss gives zero weight beyond so many scales (95 % efficient for normal errors) [Holland
// & Welsch 1977]; farther points are outliers wherever one is asked for.
inline constexpr double kTukeyTuning = 4.685;

// Fairness of a surface relative to its data, unless the user gives another (SurfaceFitOptions::
// smoothing): bridges cells without data, and costs less than 1 % of the error from noise
// elsewhere.
inline constexpr double kSurfaceSmoothing = 1e-4;

}  // namespace batten::internal
