// SPDX-License-Identifier: MIT
// Points measured, as it were, from a known shape.
#pragma once

#include <cstdint>

#include "batten/fitting/point_cloud.h"
#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"

namespace batten {

struct SampleOptions {
  Eigen::Index count = 1000;  // points, outliers included, ≥ 1
  double noise = 0;           // standard deviation in every coordinate, the shape's units, ≥ 0
  double outliers = 0;        // fraction replaced by points anywhere in the bounding box, 0 … 1
  std::uint64_t seed = 1;     // same seed, same points, on every machine
};

// Points spread evenly by area (by length on curves), with normal noise; on a trimmed surface over
// the part inside its trims. Plane curves give plane clouds. Throws std::invalid_argument naming
// the option that breaks its rule, and where trims leave no area.
PointCloud SampleGeometry(const NurbsSurface& surface, const SampleOptions& options);
PointCloud SampleGeometry(const NurbsCurve<2>& curve, const SampleOptions& options);
PointCloud SampleGeometry(const NurbsCurve<3>& curve, const SampleOptions& options);

}  // namespace batten
