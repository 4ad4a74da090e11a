// SPDX-License-Identifier: MIT
#include "batten/fitting/grid_options.h"

#include <stdexcept>
#include <string>

namespace batten {

void Check(const GridFitOptions& options) {
  const auto reject = [](const std::string& rule) {
    throw std::invalid_argument("GridFitOptions: " + rule);
  };
  if (options.rows < 2 || options.columns < 2) {
    reject("rows and columns must be 2 at least; they are " + std::to_string(options.rows) +
           " and " + std::to_string(options.columns));
  }
  Check(AsSurfaceOptions(options));
  if (options.method == GridMethod::kLeastSquares && !options.control_points) {
    reject("method least squares needs control_points");
  }
  if (options.method == GridMethod::kInterpolateLocally &&
      (options.degree_u != 3 || options.degree_v != 3)) {
    reject("local interpolation is bicubic: degree_u and degree_v must be 3");
  }
  const Eigen::Index cells = Eigen::Index{options.rows} * options.columns;
  if (options.missing.size() != 0 && options.missing.size() != cells) {
    reject("missing must have one value for each of " + std::to_string(cells) + " cells; it has " +
           std::to_string(options.missing.size()));
  }
}

SurfaceFitOptions AsSurfaceOptions(const GridFitOptions& options) {
  SurfaceFitOptions surface;
  surface.degree_u = options.degree_u;
  surface.degree_v = options.degree_v;
  surface.tolerance = options.tolerance;
  surface.control_points = options.control_points;
  surface.shift = options.shift;
  surface.threads = options.threads;
  surface.progress = options.progress;
  return surface;
}

}  // namespace batten
