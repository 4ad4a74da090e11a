// SPDX-License-Identifier: MIT
#include "batten/fitting/fit_surface.h"

#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "batten/fitting/coefficient_order.h"
#include "batten/fitting/distances.h"
#include "batten/fitting/given_parameters.h"
#include "batten/fitting/snap.h"
#include "batten/fitting/stopwatch.h"
#include "batten/fitting/surface_fitter.h"
#include "batten/fitting/surface_outcome.h"
#include "batten/fitting/surface_preparation.h"

namespace batten {
namespace {

constexpr double kExplains = 0.1;  // share of the misfit that a feature leaves

// Distances of the used points from the surface at their own parameters.
ErrorSummary AtParameters(const SurfaceFit& fit,
                          const PointCloud& cloud,
                          const SurfaceFitOptions& options) {
  const Eigen::Vector3d move = cloud.origin() - options.shift;
  Eigen::VectorXd offsets(cloud.size());
  for (Eigen::Index k = 0; k < cloud.size(); ++k) {
    const auto at = cloud.parameters().col(k);
    offsets[k] = (fit.surface.At(at[0], at[1]) - move - cloud.points().col(k)).norm();
  }
  return Summarise(offsets, options.tolerance, !fit.outliers);
}

// One cloud, its base found, to be fitted once or twice and measured.
class SurfaceRoad {
 public:
  SurfaceRoad(const PointCloud& cloud, const SurfaceFitOptions& options)
      : cloud_(cloud), pool_(options.threads) {
    if (options.given_parameters) {
      given_ = PrepareGiven(cloud, options, pool_);
    } else {
      prepared_ = PrepareCloud(cloud, options, pool_);
    }
    prepare_seconds_ = watch_.Lap();
  }

  // Whether the last fit set points aside or bounded them, unasked.
  bool doubted() const { return doubted_; }

  SurfaceFit Fit(const SurfaceFitOptions& options) {
    const PreparedCloud& prepared = given_ ? given_->prepared : prepared_;
    FittedDraft fitted = FitOverBase(prepared, options, StartReport(prepared), pool_);
    const double so_far = prepared_.base_seconds;
    if (!given_ && fitted.doubted && TakeSmallerBase(prepared_, fitted.used, options, pool_)) {
      prepare_seconds_ += prepared_.base_seconds - so_far;
      fitted = FitOverBase(prepared, options, StartReport(prepared), pool_);
    }
    doubted_ = fitted.doubted;
    if (options.snap && !given_) Snap(fitted, options);
    watch_.Lap();
    SurfaceFit fit =
        MeasureFit(given_ ? given_->InUsersUnits(fitted.draft.surface) : fitted.draft.surface,
                   cloud_,
                   prepared.merged,
                   fitted.used,
                   options,
                   prepared.base.shape,
                   pool_,
                   std::move(fitted.report));
    const bool kept =
        !fit.report.optimize.ran || (options.optimize && !options.optimize->parameters);
    if (given_ && kept) fit.report.parameter_error = AtParameters(fit, cloud_, options);
    fit.report.seconds.project += watch_.Lap();
    fit.report.seconds.total = total_.Lap();
    return fit;
  }

  // The same with every point that has a place taken for a good one.
  SurfaceFit FitAll(SurfaceFitOptions options) {
    options.keep_outliers = true;
    prepared_.used = prepared_.reached;
    prepared_.statistics.outliers.setConstant(false);
    prepared_.statistics.outlier_count = 0;
    return Fit(options);
  }

 private:
  // An exact shape in place of the free form where it explains the points as well.
  void Snap(FittedDraft& fitted, const SurfaceFitOptions& options) {
    constexpr double kRounding = 1e-12;  // of the size
    SurfaceDraft& draft = fitted.draft;
    const Eigen::VectorXd distances =
        DistancesFrom(draft.surface, draft.used.points(), draft.parameters, pool_).distances;
    const bool weighted = draft.weights.size() > 0;
    const double squares = weighted
                               ? distances.cwiseAbs2().dot(draft.weights) / draft.weights.mean()
                               : distances.squaredNorm();
    const auto& bases = std::pair(draft.surface.basis_u(), draft.surface.basis_v());
    const int unknowns = DistinctCount(bases.first) * DistinctCount(bases.second) -
                         PoleConditionCount(bases.first, bases.second, draft.poles);
    const Eigen::VectorXd weights =
        weighted ? (draft.weights / draft.weights.mean()).eval() : Eigen::VectorXd();
    std::optional<Snapped> snapped =
        SnapToPrimitive(draft.used.points(),
                        weights,
                        {squares, static_cast<double>(unknowns), options.tolerance},
                        kRounding,
                        options.seed,
                        pool_);
    GeometrySummary& geometry = fitted.report.geometry;
    if (!snapped) {
      geometry.base_why +=
          "; no plane, sphere, cylinder, cone or torus explains the points as well";
      return;
    }
    draft.surface = std::move(snapped->surface);
    geometry.primitive = std::move(snapped->summary);
    const Eigen::Vector3d move = cloud_.origin() - options.shift;
    for (auto* place :
         {&geometry.primitive->point, &geometry.primitive->center, &geometry.primitive->apex}) {
      if (*place) **place += move;
    }
    geometry.base_why += "; " + geometry.primitive->why;
    geometry.distortion = 0;
    fitted.report.warnings.insert(
        fitted.report.warnings.end(), snapped->warnings.begin(), snapped->warnings.end());
  }

  FitReport StartReport(const PreparedCloud& prepared) const {
    FitReport report;
    report.threads = pool_.threads();
    report.input = SummariseInput(cloud_, prepared.merged.duplicates, prepared.statistics);
    report.geometry.base = prepared.base.name;
    report.geometry.base_why = prepared.base.why;
    report.warnings = prepared.warnings;
    report.seconds.parameterize = prepared.base_seconds;
    report.seconds.prepare = prepare_seconds_ - prepared.base_seconds;
    return report;
  }

  const PointCloud& cloud_;
  ThreadPool pool_;
  Stopwatch watch_, total_;
  PreparedCloud prepared_;
  std::optional<GivenParameters> given_;
  double prepare_seconds_ = 0;
  bool doubted_ = false;
};

// Of a fit that set points aside and one of all points: what stands out of equal knots may be a
// narrow feature, which free knots follow; outliers nothing follows.
SurfaceFit Explained(SurfaceFit without, SurfaceFit with_all) {
  if (!(with_all.report.error_all.rms < kExplains * without.report.error_all.rms)) return without;
  with_all.report.warnings.push_back(
      "points that stand out of a shape with equal knots were kept: free knots follow them");
  return with_all;
}

}  // namespace

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
  if (!options.shift.allFinite()) reject("shift must be finite");
}

SurfaceFit FitSurface(const PointCloud& cloud, const SurfaceFitOptions& options) {
  Check(options);
  SurfaceRoad road(cloud, options);
  SurfaceFit fit = road.Fit(options);
  const bool free_knots = options.optimize && options.optimize->knots && !options.given_parameters;
  if (!road.doubted() || !free_knots) return fit;
  return Explained(std::move(fit), road.FitAll(options));
}

}  // namespace batten
