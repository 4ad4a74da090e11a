// SPDX-License-Identifier: MIT
#include "batten/fitting/surface_options.h"

#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>

#include "batten/geometry/spline_basis.h"

namespace batten {

void Check(const SurfaceFitOptions& options) {
  const auto reject = [](const std::string& rule) {
    throw std::invalid_argument("SurfaceFitOptions: " + rule);
  };
  for (const auto& [name, degree] :
       {std::pair{"degree_u", options.degree_u}, {"degree_v", options.degree_v}}) {
    if (degree < 1 || degree > kMaxDegree) {
      reject(std::string(name) + " is " + std::to_string(degree) + ", not in [1, " +
             std::to_string(kMaxDegree) + "]");
    }
  }
  if (options.tolerance && !(*options.tolerance > 0 && std::isfinite(*options.tolerance))) {
    reject("tolerance must be positive");
  }
  if (options.control_points) {
    if (options.control_points->first <= options.degree_u ||
        options.control_points->second <= options.degree_v) {
      reject("control_points must exceed the degree in both directions");
    }
    if (std::int64_t{options.control_points->first} * options.control_points->second > 1000000) {
      reject("control_points must not exceed a million in all");
    }
  }
  if (options.max_control_points < (options.degree_u + 1) * (options.degree_v + 1)) {
    reject("max_control_points is below (degree_u + 1)(degree_v + 1), the least a surface has");
  }
  if (options.smoothing && !(*options.smoothing >= 0 && std::isfinite(*options.smoothing))) {
    reject("smoothing must not be negative");
  }
  if (options.smooth_by != SmoothBy::kWeight &&
      (options.smoothing || options.tolerance ||
       options.loss.value_or(Loss::kNone) != Loss::kNone)) {
    reject("smooth_by chooses the smoothing: not beside smoothing, tolerance or loss");
  }
  if (options.loss_scale && !(*options.loss_scale > 0 && std::isfinite(*options.loss_scale))) {
    reject("loss_scale must be positive");
  }
  if (options.boundary.size() > 4) {
    reject("boundary holds " + std::to_string(options.boundary.size()) +
           " conditions; a surface has four edges");
  }
  if (!(options.boundary_tolerance >= 0) || !std::isfinite(options.boundary_tolerance))
    reject("boundary_tolerance must not be negative");
  if (options.symmetric &&
      !(options.symmetric->normal.norm() > 0 && options.symmetric->normal.allFinite() &&
        std::isfinite(options.symmetric->offset))) {
    reject("symmetric needs a plane with a normal");
  }
  if (options.domain &&
      !(options.domain->u0 < options.domain->u1 && options.domain->v0 < options.domain->v1)) {
    reject("domain must rise in both directions");
  }
  const bool conditions = !options.boundary.empty() || options.meet;
  if (options.given_parameters && (conditions || options.symmetric || options.domain))
    reject("given_parameters leaves no base that conditions, symmetry or a domain could shape");
  if (options.snap && (conditions || options.symmetric))
    reject("snap: an exact shape meets no conditions");
  if (options.terms &&
      (conditions || options.symmetric || options.snap || options.given_parameters)) {
    reject(
        "terms go with free points: not beside boundary, meet, symmetric, snap or "
        "given_parameters");
  }
  if (options.symmetric && (conditions || options.domain))
    reject("symmetric with boundary, meet or domain is not in this version");
  if (options.domain && !options.boundary.empty())
    reject("domain and boundary both say where the surface ends");
  if (options.thin && !(*options.thin > 0 && std::isfinite(*options.thin)))
    reject("thin must be positive");
  if (!options.shift.allFinite()) reject("shift must be finite");
}

}  // namespace batten
