// SPDX-License-Identifier: MIT
// Turns a fitted plane, sphere, cylinder, cone or torus into the result of FitPrimitive.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "batten/fitting/primitive_options.h"
#include "batten/geometry/exact_shape.h"
#include "fitting/primitives/primitive_input.h"
#include "fitting/primitives/shape_fitter.h"

namespace batten::internal {

// A fitted surface with the patch its points cover and the standard deviations of its parameters.
// Everything is in the points' coordinates plus `move`.
struct DescribedSurface {
  ExactSurface patch;
  NurbsSurface surface;
  PrimitiveSummary summary;
  std::vector<std::string> warnings;
};

// Patch and parameters of a fitted surface. Throws std::invalid_argument as PatchOf does, and where
// the points are flat. Distances below `rounding` (of the fitter's unit) count as that large. O(m).
DescribedSurface Described(const ShapeFit& fit,
                           ShapeFitter& fitter,
                           const Eigen::Matrix3Xd& points,
                           const Eigen::Vector3d& move,
                           double rounding,
                           ThreadPool& pool);

// The parameters of a shape that has this patch, `middle` the middle of its points; plus `move`.
PrimitiveSummary NumbersOf(const SurfaceShape& shape,
                           const ExactSurface& patch,
                           const Eigen::Vector3d& middle,
                           const Eigen::Vector3d& move);

// Whether positive distances are on the side that S_u × S_v of the patch looks to: outward, of
// planes where the patch's axis is.
bool LooksAlike(const FittedSurface& shape, const ExactSurface& patch);

// The area of the patch.
double AreaOf(const ExactSurface& patch);

// The result of FitPrimitive for a surface. Points beyond the edges of the patch have their
// distance from the patch.
PrimitiveFit SurfaceMeasurement(PrimitiveInput& input,
                                ShapeFitter& fitter,
                                const ShapeFit& fit,
                                const std::string& why);

}  // namespace batten::internal
