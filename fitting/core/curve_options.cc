// SPDX-License-Identifier: MIT
#include "batten/fitting/curve_options.h"

#include <cmath>
#include <string>

#include "batten/geometry/spline_basis.h"
#include "geometry/numeric/reject.h"

namespace batten {
using namespace internal;
void Check(const CurveFitOptions& options) {
  if (options.degree < 1 || options.degree > kMaxDegree) {
    Reject("CurveFitOptions",
           "degree is " + std::to_string(options.degree) + ", not in [1, " +
               std::to_string(kMaxDegree) + "]");
  }
  if (options.tolerance && !(*options.tolerance > 0 && std::isfinite(*options.tolerance))) {
    Reject("CurveFitOptions", "tolerance must be positive");
  }
  if (options.control_points && *options.control_points <= options.degree) {
    Reject("CurveFitOptions", "control_points must exceed the degree");
  }
  constexpr int kMostControlPoints = 1000000;
  if (options.control_points && *options.control_points > kMostControlPoints) {
    Reject("CurveFitOptions", "control_points must not exceed a million");
  }
  if (options.control_points && *options.control_points > options.max_control_points) {
    Reject("CurveFitOptions", "control_points must not exceed max_control_points");
  }
  if (options.loss_scale && options.loss && *options.loss == Loss::kNone) {
    Reject("CurveFitOptions", "loss_scale is of no use without a loss");
  }
  if (options.max_control_points <= options.degree) {
    Reject("CurveFitOptions", "max_control_points must exceed the degree");
  }
  if (options.smoothing && !(*options.smoothing >= 0 && std::isfinite(*options.smoothing))) {
    Reject("CurveFitOptions", "smoothing must not be negative");
  }
  if (options.smooth_by != SmoothBy::kWeight && options.smoothing) {
    Reject("CurveFitOptions", "smoothing is given and to be chosen");
  }
  if (options.smooth_by != SmoothBy::kWeight && options.loss && *options.loss != Loss::kNone) {
    Reject("CurveFitOptions", "smoothing can't be chosen under a loss");
  }
  if (options.smooth_by != SmoothBy::kWeight && options.tolerance) {
    Reject("CurveFitOptions", "smoothing can't be chosen where a tolerance decides");
  }
  if (options.loss_scale && !(*options.loss_scale > 0 && std::isfinite(*options.loss_scale))) {
    Reject("CurveFitOptions", "loss_scale must be positive");
  }
  if (options.distance == CurveDistance::kParameter && options.optimize &&
      options.optimize->parameters) {
    Reject("CurveFitOptions", "optimize frees the parameters that distance holds every point to");
  }
  if (options.parameterization == CurveParameterization::kGiven) {
    if (options.smooth_by != SmoothBy::kWeight)
      Reject("CurveFitOptions", "smoothing can't be chosen at given parameters");
    if (options.order == PointOrder::kUnordered)
      Reject("CurveFitOptions",
             "parameterization given is an order already; order can't be unordered");
    if (options.closed == ClosedChoice::kYes)
      Reject("CurveFitOptions",
             "given parameters can't close: they do not tell the way from the last point to the "
             "first");
  }
  if (!options.shift.allFinite()) Reject("CurveFitOptions", "shift must be finite");
}

}  // namespace batten
