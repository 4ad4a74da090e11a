// SPDX-License-Identifier: MIT
// Deviations of form: flatness, roundness, sphericity, cylindricity, by minimum zone.
#pragma once

#include <string>

#include "batten/fitting/point_cloud.h"
#include "batten/fitting/primitive_options.h"

namespace batten {

// The width of the zone between two shapes of one kind, a constant distance apart, that holds all
// points: parallel planes, concentric circles (of the points' distances in the circle's plane) or
// spheres, coaxial cylinders. [ISO 12781, 12181, 12180]
struct FormDeviation {
  std::string name;          // "flatness", "roundness", "sphericity", "cylindricity"
  double least_squares = 0;  // width about the shape of least squares
  double minimum_zone = 0;   // the least width, found from there
  // Standard deviation of the width by the noise of the points that touch the zone's sides: σ √2
  // for one on either side, 0 where the noise is unknown. The width itself is too large by noise:
  // the points that touch are those the noise drove outwards.
  double deviation = 0;
  Eigen::Index points = 0;  // those of the fit; its outliers do not count
};

// Of a plane, circle, sphere or cylinder that was fitted to the cloud. The minimum zone is the best
// in the neighbourhood of the fit, which for forms that are nearly true is the least of all: a
// sequence of linear Chebyshev problems, each solved exactly by exchange [Stiefel 1959; Watson
// 1980, §2.5], until the width falls no more. Throws std::invalid_argument for other kinds, or
// where the cloud is not the fit's. O(m) an exchange, a few dozen exchanges. `shift` is that of the
// fit's options.
FormDeviation FormDeviationOf(const PrimitiveFit& fit,
                              const PointCloud& cloud,
                              const Eigen::Vector3d& shift = Eigen::Vector3d::Zero());

// Whether the kind of shape has a deviation of form.
bool HasForm(const PrimitiveFit& fit);

}  // namespace batten
