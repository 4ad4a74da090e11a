// SPDX-License-Identifier: MIT
// Constants that several rooms share.
#pragma once

namespace batten::internal {

// Tukey's loss gives zero weight beyond so many scales (95 % efficient for normal errors) [Holland
// & Welsch 1977]; farther points are outliers wherever one is asked for.
inline constexpr double kTukeyTuning = 4.685;

// Loss::kTruncated, as efficient, gives it to all beyond so many.
inline constexpr double kTruncatedTuning = 2.795;

// Root mean square errors up to so many times the noise are noise …
inline constexpr double kAtNoise = 1.5;

// … and up to so many, where neighbours share it: nearest ones show less than there is.
inline constexpr double kSharedAtMost = 2.5;

// Fairness of a surface relative to its data, unless the user gives another (SurfaceFitOptions::
// smoothing): bridges cells without data, and costs less than 1 % of the error from noise
// elsewhere.
inline constexpr double kSurfaceSmoothing = 1e-4;

// Standard deviations that normal errors hardly ever exceed: once in 370 times.
inline constexpr double kThreeSigmas = 3;

// Points of a surface.
inline constexpr int kFewestSurfacePoints = 4;

// Limit of iterations that end by themselves long before it, so that none goes on for ever.
inline constexpr int kMostIterations = 500;

// Rounds of a robust mean or fit of a few points, whose weights hardly change any more.
inline constexpr int kRobustRounds = 3;

// Points that a thread takes at once, where at most the order of sums depends on it.
inline constexpr int kPointsPerTask = 1024;

// The same where a point takes long (a search, a robust fit): 1024 would make too few tasks.
inline constexpr int kSlowPointsPerTask = 256;

// Points in memory that are handed on at once: some such pieces stay in the caches.
inline constexpr int kPointsOfPiece = 1 << 16;

}  // namespace batten::internal
