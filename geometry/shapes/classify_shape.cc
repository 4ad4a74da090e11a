// SPDX-License-Identifier: MIT
#include "batten/geometry/classify_shape.h"

#include <array>
#include <cmath>
#include <stdexcept>

namespace batten {

std::string NameOf(const CurveShape& shape) {
  static constexpr std::array kNames{"free", "line", "circle", "ellipse", "parabola", "hyperbola"};
  static_assert(kNames.size() == std::variant_size_v<CurveShape>);
  return kNames[shape.index()];
}

std::string NameOf(const SurfaceShape& shape) {
  static constexpr std::array kNames{
      "free", "plane", "cylinder", "sphere", "cone", "torus", "revolution", "extrusion"};
  static_assert(kNames.size() == std::variant_size_v<SurfaceShape>);
  return kNames[shape.index()];
}

double ConicShapeFactor(double w0, double w1, double w2) { return w0 / w1 * (w2 / w1); }

ConicKind ClassifyConic(double w0, double w1, double w2, double tolerance) {
  if (!(w0 * w2 > 0) || w1 == 0 || !std::isfinite(w0) || !std::isfinite(w1) || !std::isfinite(w2)) {
    throw std::invalid_argument("ClassifyConic: weights " + std::to_string(w0) + ", " +
                                std::to_string(w1) + ", " + std::to_string(w2) +
                                " are not finite with w0 w2 > 0 and w1 not 0");
  }
  if (!(tolerance >= 0)) {
    throw std::invalid_argument("ClassifyConic: tolerance = " + std::to_string(tolerance) +
                                " is negative");
  }
  const double k = ConicShapeFactor(w0, w1, w2);
  if (std::abs(k - 1) <= tolerance) return ConicKind::kParabola;
  return k > 1 ? ConicKind::kEllipse : ConicKind::kHyperbola;
}

}  // namespace batten
