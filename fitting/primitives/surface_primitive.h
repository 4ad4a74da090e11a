// SPDX-License-Identifier: MIT
// The plane, sphere, cylinder, cone or torus of FitPrimitive, from its fit to what is handed out.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "batten/fitting/primitive_options.h"
#include "batten/geometry/exact_shape.h"
#include "fitting/primitives/primitive_input.h"
#include "fitting/primitives/shape_fitter.h"

namespace batten::internal {

// A fitted surface with what its points cover of it and how exactly they determine it. Everything
// is in the points' coordinates plus `move`.
struct DescribedSurface {
  ExactSurface patch;
  NurbsSurface surface;
  PrimitiveSummary summary;
  std::vector<std::string> warnings;
};

// Throws std::invalid_argument as PatchOf does, and where the points are flat. Distances below
// `rounding` (of the fitter's unit) count as that large. O(m).
DescribedSurface Described(const ShapeFit& fit,
                           ShapeFitter& fitter,
                           const Eigen::Matrix3Xd& points,
                           const Eigen::Vector3d& move,
                           double rounding,
                           ThreadPool& pool);

// Of the patch.
double AreaOf(const ExactSurface& patch);

// What FitPrimitive hands out. Distances of points beyond the edges of the patch are those from it.
PrimitiveFit SurfaceMeasurement(PrimitiveInput& input,
                                ShapeFitter& fitter,
                                const ShapeFit& fit,
                                const std::string& why);

}  // namespace batten::internal
