// SPDX-License-Identifier: MIT
#include "fitting/primitives/snap.h"

#include <algorithm>
#include <cstdio>
#include <stdexcept>
#include <utility>

#include "fitting/core/distributions.h"
#include "fitting/primitives/shape_fitter.h"

namespace batten::internal {
namespace {

std::string Sentence(SurfaceKind kind, double f, double chance) {
  char text[120];
  std::snprintf(text,
                sizeof text,
                "a %s explains the points as well (F = %.2f, p = %.2g): snapped to it",
                Name(kind),
                f,
                chance);
  return text;
}

}  // namespace

std::optional<DescribedSurface> SnapToPrimitive(const Eigen::Matrix3Xd& points,
                                                const Eigen::VectorXd& weights,
                                                const FreeFormResidual& free_form,
                                                double rounding,
                                                std::uint64_t seed,
                                                ThreadPool& pool) {
  constexpr double kLevel = 0.01;
  const auto count = static_cast<double>(points.cols());
  const double left = count - free_form.unknowns;
  if (!(left > 0) || points.cols() < 2) return std::nullopt;
  ShapeFitOptions options;
  options.loss = Loss::kNone;  // the same points as the free form's
  options.rounding = rounding;
  options.seed = seed;
  ShapeFitter fitter(points, weights, options, pool);
  const double least = rounding * fitter.unit();
  const double squares = std::max(free_form.squares, count * least * least);
  for (const SurfaceKind kind : kSurfaceKinds) {
    const double more = free_form.unknowns - FreedomsOf(kind);
    if (!(more > 0) || points.cols() <= FreedomsOf(kind)) continue;
    try {
      const ShapeFit fit = fitter.Fit(kind);
      const double fall = std::max(0.0, fit.squares - squares);
      const double f = (fall / more) / (squares / left), chance = FTail(f, more, left);
      const bool within =
          !free_form.tolerance || fit.distances.cwiseAbs().maxCoeff() <= *free_form.tolerance;
      if (!(chance > kLevel) || !within) continue;
      DescribedSurface described =
          Described(fit, fitter, points, Eigen::Vector3d::Zero(), rounding, pool);
      described.summary.why = Sentence(kind, f, chance);
      return described;
    } catch (const std::invalid_argument&) {
      continue;  // no shape of this kind
    }
  }
  return std::nullopt;
}

}  // namespace batten::internal
