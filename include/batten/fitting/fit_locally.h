// SPDX-License-Identifier: MIT
// Local methods for the points of a cloud, in their order: through all, or within a tolerance.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "batten/fitting/curve_options.h"
#include "batten/fitting/local_interpolation.h"
#include "batten/fitting/point_cloud.h"

namespace batten {

struct LocalFitOptions {
  LocalPieces pieces = LocalPieces::kCubics;
  // None: every point is met; else as few pieces as a greedy search finds keep it: conics or
  // cubics. > 0, in the data's units.
  std::optional<double> tolerance = std::nullopt;
  bool closed = false;  // the first point may be there again at the end
  bool corners = true;  // found and kept; else the curve has a tangent everywhere
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();  // subtracted from the coordinates of the result
};

// InterpolateLocally, with Akima's tangents, or ApproximateLocally, for the points in their order;
// points in a row that agree in place count once. Weights and parameters of the cloud do not
// count. Interpolating, residuals are those at the points' parameters: rounding; approximating,
// orthogonal distances. O(m). Throws std::invalid_argument, with a sentence for the user, as those
// and OrderPoints do, and where parabolas are to keep a tolerance.
template <int Dim>
CurveFit<Dim> FitLocally(const PointCloud& cloud, const LocalFitOptions& options = {});

extern template CurveFit<2> FitLocally<2>(const PointCloud&, const LocalFitOptions&);
extern template CurveFit<3> FitLocally<3>(const PointCloud&, const LocalFitOptions&);

}  // namespace batten
