// SPDX-License-Identifier: MIT
#include "geometry/measure/join_tolerances.h"

#include <cmath>
#include <limits>
#include <stdexcept>

#include "geometry/numeric/number_text.h"
#include "geometry/numeric/constants.h"

namespace batten::internal {
namespace {

constexpr double kRelativeGap = 1e-9;

void RequirePositive(const std::string& function, const char* name, double value) {
  if (value > 0) return;
  throw std::invalid_argument(function + ": " + name + " = " + NumberText(value) +
                              " is not positive");
}

}  // namespace

void JoinScale::SetPosition(const std::string& function) {
  if (options_.position_tolerance) {
    RequirePositive(function, "position_tolerance", *options_.position_tolerance);
  }
  RequirePositive(function, "angle_tolerance", options_.angle_tolerance);
  RequirePositive(function, "curvature_tolerance", options_.curvature_tolerance);
  RequirePositive(function, "derivative_tolerance", options_.derivative_tolerance);
  constexpr double kPlaces = 8;
  position_ = std::max(options_.position_tolerance.value_or(kRelativeGap * size_),
                       kPlaces * kEpsilon * coordinate_);
}

double JoinScale::rounding() const {
  constexpr double kPlaces = 64;
  return kPlaces * kEpsilon * coordinate_;
}

bool JoinScale::Equal(const Eigen::Vector3d& a,
                      const Eigen::Vector3d& b,
                      double least,
                      double rounding) const {
  const double longest = std::max({a.norm(), b.norm(), least});
  return (a - b).norm() <= options_.derivative_tolerance * longest + rounding;
}

bool JoinScale::EquallyCurved(double gap, double curvature) const {
  return gap <= options_.curvature_tolerance * std::max(curvature, 1 / size_);
}

double Steepness(const SplineBasis& basis, double u) {
  const int span = basis.Span(u);
  return basis.degree() / (basis.knots()[span + 1] - basis.knots()[span]);
}

}  // namespace batten::internal
