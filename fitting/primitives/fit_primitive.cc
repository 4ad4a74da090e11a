// SPDX-License-Identifier: MIT
#include "batten/fitting/fit_primitive.h"

#include <cmath>
#include <cstdio>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <string>

#include "fitting/core/distributions.h"
#include "fitting/core/fit_end.h"
#include "fitting/primitives/curve_primitive.h"
#include "fitting/primitives/primitive_input.h"
#include "fitting/primitives/surface_choice.h"
#include "fitting/primitives/surface_primitive.h"

namespace batten {
using namespace internal;
namespace {

// Surfaces have the kinds from the plane on, in the same order.
std::optional<SurfaceKind> SurfaceOf(PrimitiveKind kind) {
  if (kind < PrimitiveKind::kPlane || kind > PrimitiveKind::kTorus) return std::nullopt;
  return static_cast<SurfaceKind>(static_cast<int>(kind) - static_cast<int>(PrimitiveKind::kPlane));
}

ShapeFitOptions ShapeOptions(const PrimitiveInput& input) {
  ShapeFitOptions options;
  options.loss = input.options.loss;
  options.scale = input.options.loss_scale;
  options.rounding = input.rounding;
  options.seed = input.options.seed;
  return options;
}

// Whether residuals of neighbouring points are correlated; if so, warns that the kind is wrong or
// that the points are bent systematically.
bool WarnOfStructure(PrimitiveInput& input, const ShapeFit& fit) {
  constexpr double kMostShared = 0.75;  // the distances are twice the noise then
  const double shared =
      SharedVariance(fit, input.points(), 10 * input.rounding * input.unit, input.options.seed);
  if (!(shared > kMostShared)) return false;
  char percent[16];
  std::snprintf(percent, sizeof percent, "%.0f %%", 100 * shared);
  const std::string name = Name(fit.kind);
  input.report.warnings.push_back(
      input.options.kind == PrimitiveKind::kAuto
          ? "no line, circle, plane, sphere, cylinder, cone or torus explains the points; the " +
                name + " is the nearest: neighbours have " + percent +
                " of their squared distance from it in common"
          : "neighbours have " + std::string(percent) + " of their squared distance from the " +
                name + " in common: the points are of another shape, or their errors go together");
  return true;
}

// Where the residuals are structured they are no noise.
void SayStructured(bool structured, const PointCloud& cloud, PrimitiveFit& fit) {
  if (structured && fit.report.termination == Termination::kNoiseReached)
    JudgeEnd({.structured = true, .farthest = FarthestPoint(fit, cloud)}, fit.report);
}

// The curve fit with a warning where the points are too far off it for measurement noise.
PrimitiveFit NearestCurve(CurvePrimitive& curve, const PrimitiveInput& input) {
  constexpr double kFarOff = 0.03;  // of the points' extent
  PrimitiveFit fit = curve.Fit();
  const InputSummary& summary = fit.report.input;
  const double size = (summary.box_max - summary.box_min).norm();
  if (fit.report.error.rms > kFarOff * size) {
    char percent[16];
    std::snprintf(percent, sizeof percent, "%.0f %%", 100 * fit.report.error.rms / size);
    fit.report.warnings.push_back(
        "no line, circle, plane, sphere, cylinder, cone or torus explains the points; the " +
        fit.report.geometry.primitive->kind + " is the nearest: they are off it by " + percent +
        " of their extent");
    SayStructured(true, input.cloud, fit);
  }
  return fit;
}

PrimitiveFit FitSurfaceOf(PrimitiveInput& input, SurfaceKind kind) {
  if (input.plane()) {
    throw std::invalid_argument(std::string("points of the plane are of no ") + Name(kind) +
                                ": a surface needs three coordinates");
  }
  input.Require(Name(kind), FreedomsOf(kind));
  Report(input.options.progress, "solve", 0);
  ShapeFitter fitter(input.points(), input.merged.cloud.weights(), ShapeOptions(input), input.pool);
  const ShapeFit fit = fitter.Fit(kind);
  const bool structured = WarnOfStructure(input, fit);
  PrimitiveFit result = SurfaceMeasurement(input, fitter, fit, "asked for");
  SayStructured(structured, input.cloud, result);
  return result;
}

// Whether the points' distances from the curve are larger than those from the surface by chance
// only: noise is the same in all directions.
bool NoiseExplains(const CurvePrimitive& curve, const ShapeFit& fit, const PrimitiveInput& input) {
  constexpr double kChance = 1e-6;  // the surface is the best of several
  const double sigma = std::max(fit.sigma / input.unit, input.rounding);
  const double ratio = curve.Sigma() / sigma;
  const double left = std::max<double>(1, static_cast<double>(fit.used - fit.freedoms));
  return FTail(ratio * ratio, curve.FreedomsLeft(), left) > kChance;
}

// CurvePrimitive::Surprise for a surface, with places spread evenly over the patch.
double SurpriseOf(const ShapeFit& fit,
                  const DescribedSurface& described,
                  const PrimitiveInput& input) {
  const double unit = input.unit, sigma = std::max(fit.sigma / unit, input.rounding);
  const auto count = static_cast<double>(fit.used);
  const double area = std::max(AreaOf(described.patch) / (unit * unit), sigma * sigma);
  return count * (std::log(2 * std::numbers::pi * std::numbers::e * sigma * sigma) +
                  2 * std::log(area)) +
         fit.freedoms * std::log(count) + input.Anywhere(fit.distances.size() - fit.used);
}

// kAuto tries curves first. Points spread across a curve are more likely on a surface, from which
// each has one distance component only.
PrimitiveFit FitAny(PrimitiveInput& input) {
  CurvePrimitive curve(input, PrimitiveKind::kAuto);
  if (input.plane()) return NearestCurve(curve, input);
  ShapeFitter fitter(input.points(), input.merged.cloud.weights(), ShapeOptions(input), input.pool);
  std::optional<SurfaceChoice> chosen = ChooseSurface(fitter, input.rounding, input.pool);
  if (!chosen) return NearestCurve(curve, input);
  try {
    const DescribedSurface described =
        Described(chosen->fit, fitter, input.points(), input.move, input.rounding, input.pool);
    if (NoiseExplains(curve, chosen->fit, input) ||
        !(SurpriseOf(chosen->fit, described, input) < curve.Surprise())) {
      return NearestCurve(curve, input);
    }
  } catch (const std::invalid_argument&) {
    return NearestCurve(curve, input);  // the points are on one line of the surface
  }
  input.report.iterations.clear();
  input.report.warnings.clear();
  const bool structured = WarnOfStructure(input, chosen->fit);
  PrimitiveFit result = SurfaceMeasurement(input, fitter, chosen->fit, chosen->why);
  SayStructured(structured, input.cloud, result);
  return result;
}

}  // namespace

PrimitiveFit FitPrimitive(const PointCloud& cloud, const PrimitiveFitOptions& options) {
  Check(options);
  PrimitiveInput input(cloud, options);
  if (const std::optional<SurfaceKind> kind = SurfaceOf(options.kind)) {
    return FitSurfaceOf(input, *kind);
  }
  if (options.kind == PrimitiveKind::kAuto) return FitAny(input);
  return CurvePrimitive(input, options.kind).Fit();
}

}  // namespace batten
