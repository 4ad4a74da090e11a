// SPDX-License-Identifier: MIT
// Torus fit to nodes.
#pragma once

#include "fitting/revolution/revolution_axis.h"
#include "fitting/revolution/revolution_samples.h"

namespace batten::internal {

// A torus about the third direction of a frame, its tube's centre at height 0.
struct Ring {
  AxisFrame frame;
  double radius = 0, tube = 0;
  double misfit = 0;  // over the radius
};

// Fits a torus by orthogonal least squares, from an approximate axis and the algebraic circle
// through the nodes' half plane; the misfit is infinite where none is found. O(n).
Ring FitTorus(const RevolutionSamples& round, const AxisFrame& start, ThreadPool& pool);

}  // namespace batten::internal
