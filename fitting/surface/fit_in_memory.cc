// SPDX-License-Identifier: MIT
#include "fitting/surface/fit_in_memory.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "batten/fitting/distances.h"
#include "batten/fitting/refused_data.h"
#include "batten/geometry/surface_evaluator.h"
#include "fitting/cloud/voxel_downsample.h"
#include "fitting/core/stage_clock.h"
#include "fitting/surface/data_box.h"
#include "fitting/surface/fit_over_base.h"
#include "fitting/surface/given_parameters.h"
#include "fitting/surface/hold_between_points.h"
#include "fitting/surface/surface_measurement.h"
#include "fitting/surface/surface_overshoot.h"
#include "fitting/surface/surface_postprocess.h"
#include "fitting/surface/surface_preparation.h"

namespace batten::internal {
namespace {

constexpr double kExplains = 0.1;  // misfit of all points over that without them; below: a feature

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

// The fit of one prepared cloud: fitted once or twice, then measured.
class SurfacePipeline {
 public:
  SurfacePipeline(const PointCloud& cloud,
                  const SurfaceFitOptions& options,
                  StageClock& clock,
                  std::optional<CloudSymmetry> symmetry = std::nullopt)
      : cloud_(cloud), pool_(options.threads), clock_(clock) {
    if (options.given_parameters) {
      given_ = PrepareGiven(cloud, options, pool_, clock);
    } else {
      prepared_ = PrepareCloud(cloud, options, pool_, clock, std::move(symmetry));
    }
  }

  // Whether the last fit set outliers aside or bounded them without being asked to.
  bool doubted() const { return used_robust_weights_; }

  SurfaceFit Fit(const SurfaceFitOptions& asked) {
    const SurfaceFitOptions options = WithDegreesOfSides(asked);
    const PreparedCloud& prepared = given_ ? given_->prepared : prepared_;
    FittedState fitted = Trimmed(prepared, options);
    if (options.trim != Trimming::kNone && !fitted.draft.surface.trimmed() &&
        BeyondBox(fitted.draft.surface, fitted.draft.used.points()) > 0) {
      SurfaceFitOptions untrimmed = options;  // its corners stay
      untrimmed.trim = Trimming::kNone;
      fitted = Trimmed(prepared, untrimmed);
    }
    used_robust_weights_ = fitted.doubted;
    if (options.domain) TakeParametersOf(*options.domain, fitted.draft);
    if (options.side_of_normals) TakeSideOfNormals(fitted.draft);
    clock_.Enter(&StageSeconds::project);
    SurfaceFit fit =
        MeasureFit(given_ ? given_->InUsersUnits(fitted.draft.surface) : fitted.draft.surface,
                   cloud_,
                   prepared.merged,
                   fitted.used,
                   options,
                   prepared.base.shape,
                   pool_,
                   std::move(fitted.report),
                   nullptr,
                   given_ ? nullptr : &fitted.draft.parameters);
    fit.estimator = std::move(fitted.draft.estimator);
    fit.estimator.shift = options.shift;
    if (fit.report.geometry.primitive)
      fit.estimator.refused = "the report gives the deviations of an exact shape's numbers";
    if (options.terms) fit.estimator.refused = "the user's terms shape it beside the points";
    const bool kept =
        !fit.report.optimize.ran || (options.optimize && !options.optimize->parameters);
    if (given_ && kept) fit.report.parameter_error = AtParameters(fit, cloud_, options);
    return fit;
  }

  // Fits again with every parameterized point as an inlier.
  SurfaceFit FitAll(SurfaceFitOptions options) {
    options.keep_outliers = true;
    prepared_.used = prepared_.reached;
    prepared_.statistics.outliers.setConstant(false);
    prepared_.statistics.outlier_count = 0;
    return Fit(options);
  }

 private:
  // The fit over the prepared base; where that takes two sheets for one, over that of a thin
  // section with a sharp edge, if the points are one.
  FittedState Fitted(const PreparedCloud& prepared, const SurfaceFitOptions& options) {
    try {
      return FitOverBase(prepared,
                         options,
                         StartReport(prepared, cloud_, prepared.merged.duplicates, pool_.threads()),
                         pool_,
                         clock_);
    } catch (const TwoSheets&) {
      if (given_ || prepared.symmetry || options.base != BaseShape::kAuto) throw;
      std::optional<PreparedCloud> wing = PreparedAsWing(options);
      if (!wing) throw;
      for (BaseCandidate& row : prepared_.candidates)
        if (row.refused.empty()) row.refused = "takes two sheets for one";
      wing->candidates.insert(
          wing->candidates.begin(), prepared.candidates.begin(), prepared.candidates.end());
      prepared_ = *std::move(wing);
    }
    return FitOverBase(prepared_,
                       options,
                       StartReport(prepared_, cloud_, prepared_.merged.duplicates, pool_.threads()),
                       pool_,
                       clock_);
  }

  std::optional<PreparedCloud> PreparedAsWing(SurfaceFitOptions options) {
    options.base = BaseShape::kWing;
    try {
      return PrepareCloud(cloud_, options, pool_, clock_);
    } catch (const RefusedData&) {
      return std::nullopt;
    }
  }

  FittedState Trimmed(const PreparedCloud& prepared, const SurfaceFitOptions& options) {
    FittedState fitted = Fitted(prepared, options);
    clock_.Enter(&StageSeconds::solve);
    if (options.snap && !given_) SnapToShape(fitted, cloud_, options, pool_);
    if (prepared_.symmetry) MakeNetSymmetric(fitted.draft.surface, *prepared_.symmetry);
    clock_.Enter(&StageSeconds::trim);
    TrimToUsed(fitted, prepared, options, pool_);
    const FitReport& report = fitted.report;
    const bool free = !prepared.conditions.any() && !prepared_.symmetry && !options.terms &&
                      !report.geometry.primitive;
    if (free && options.trim != Trimming::kNone) {
      HoldBetweenPoints(fitted.draft,
                        prepared.statistics.spacing,
                        DirectionOfHeights(report),
                        options.tolerance,
                        options.progress,
                        pool_);
    }
    return fitted;
  }

  // Degrees high enough for the given boundary curves.
  SurfaceFitOptions WithDegreesOfSides(SurfaceFitOptions options) const {
    for (const PlacedBoundary& laid : prepared_.conditions.sides) {
      int& degree = laid.edge.direction == Direction::kU ? options.degree_v : options.degree_u;
      degree = std::max(degree, laid.side.curve.basis().degree());
    }
    return options;
  }

  const PointCloud& cloud_;
  ThreadPool pool_;
  StageClock& clock_;
  PreparedCloud prepared_;
  std::optional<GivenParameters> given_;
  bool used_robust_weights_ = false;
};

// Chooses between a fit that set points aside and one of all points: points off a fit with uniform
// knots may be a narrow feature, which free knots follow; no fit follows outliers.
SurfaceFit Explained(SurfaceFit without, SurfaceFit with_all) {
  if (!(with_all.report.error_all.rms < kExplains * without.report.error_all.rms)) return without;
  with_all.report.warnings.push_back(
      "points that stand out of a shape with equal knots were kept: free knots follow them");
  return with_all;
}

// Converts the fit of a cloud with its mirror image to a fit of the cloud.
SurfaceFit FitSymmetric(const PointCloud& cloud,
                        const SurfaceFitOptions& options,
                        StageClock& clock) {
  MirrorPlane plane = *options.symmetric;
  const double length = plane.normal.norm();
  plane = {plane.normal / length, plane.offset / length};
  SymmetricCloud both = WithMirrorImage(cloud, plane);
  SurfacePipeline road(both.cloud,
                       options,
                       clock,
                       CloudSymmetry{plane.From(both.cloud.origin()), std::move(both.twins)});
  SurfaceFit fit = road.Fit(options);
  const Eigen::Index own = cloud.size();
  fit.parameters.conservativeResize(2, own);
  fit.residuals.conservativeResize(own);
  fit.outliers.conservativeResize(own);
  fit.estimator.symmetric = plane.From(options.shift);
  FitReport& report = fit.report;
  report.error = Summarise(fit.residuals, options.tolerance, !fit.outliers);
  report.error_all = Summarise(fit.residuals, options.tolerance);
  if (report.end.where) {  // not a point's mirror image
    Eigen::Index farthest = 0;
    fit.outliers.select(0, fit.residuals.array().abs()).maxCoeff(&farthest);
    report.end.where = cloud.World(farthest);
  }
  report.input.points = own;
  report.input.duplicates = MergeDuplicates(cloud).duplicates;
  report.input.used = report.error.points;
  report.input.outliers = fit.outliers.count();
  report.input.box_min = cloud.origin() + cloud.points().rowwise().minCoeff();
  report.input.box_max = cloud.origin() + cloud.points().rowwise().maxCoeff();
  return fit;
}

// Distances of all points of a cloud from the fit of some of them.
PointDistances AllDistances(const PointCloud& cloud,
                            const DownsampledCloud& thinned,
                            const SurfaceFit& fit,
                            const SurfaceFitOptions& options) {
  Eigen::Matrix2Xd near(2, cloud.size());
  for (Eigen::Index k = 0; k < cloud.size(); ++k)
    near.col(k) = fit.parameters.col(thinned.stands[static_cast<std::size_t>(k)]);
  ThreadPool pool(options.threads);
  return DistancesTo(
      fit.surface.Translated(options.shift - cloud.origin()), cloud.points(), near, pool);
}

// The points left out by thinning that lie less than a cell beyond the border of the fit, since a
// thinned cloud ends inside the full one.
std::vector<Eigen::Index> BeyondTheBorder(const PointCloud& cloud,
                                          const DownsampledCloud& thinned,
                                          const SurfaceFit& fit,
                                          const PointDistances& found,
                                          const SurfaceFitOptions& options) {
  constexpr double kAside = 0.5;  // tangential share of the way to the foot point
  const double reach = std::sqrt(3.0) * *options.thin;
  const SurfaceEvaluator surface(fit.surface.Translated(options.shift - cloud.origin()));
  std::vector<Eigen::Index> beyond;
  for (Eigen::Index k = 0; k < cloud.size(); ++k) {
    const double distance = std::abs(found.distances[k]);
    if (thinned.kept[static_cast<std::size_t>(thinned.stands[static_cast<std::size_t>(k)])] == k ||
        distance > reach || distance <= 3 * fit.report.error.rms) {
      continue;
    }
    const double u = found.parameters(0, k), v = found.parameters(1, k);
    const auto normal = surface.NormalAt(u, v);
    if (!normal) continue;
    const Eigen::Vector3d off = cloud.points().col(k) - surface.At(u, v);
    if ((off - normal->dot(off) * *normal).norm() > kAside * distance) beyond.push_back(k);
  }
  return beyond;
}

// Converts the fit of a thinned cloud to a fit of the cloud, with every point measured.
SurfaceFit FitDownsampled(const PointCloud& cloud,
                          const SurfaceFitOptions& options,
                          StageClock& clock) {
  DownsampledCloud thinned = Thinned(cloud, *options.thin);
  SurfaceFitOptions plain = options;
  plain.thin.reset();
  SurfaceFit fit = FitInMemory(thinned.cloud, plain, clock);
  PointDistances found = AllDistances(cloud, thinned, fit, options);
  if (const auto beyond = BeyondTheBorder(cloud, thinned, fit, found, options); !beyond.empty()) {
    thinned = WithPoints(cloud, std::move(thinned), beyond);
    clock.Enter(&StageSeconds::prepare);
    fit = FitInMemory(thinned.cloud, plain, clock);
    found = AllDistances(cloud, thinned, fit, options);
  }
  const Eigen::Index all = cloud.size(), stayed = thinned.cloud.size();
  PointMask outliers = PointMask::Constant(all, false), left_out = !outliers;
  for (Eigen::Index k = 0; k < stayed; ++k) {
    outliers[thinned.kept[static_cast<std::size_t>(k)]] = fit.outliers[k];
    left_out[thinned.kept[static_cast<std::size_t>(k)]] = false;
  }
  fit.parameters = std::move(found.parameters);
  fit.residuals = std::move(found.distances);
  fit.outliers = std::move(outliers);
  fit.estimator.used = !left_out && !fit.outliers;
  FitReport& report = fit.report;
  report.error_all = Summarise(fit.residuals, options.tolerance);
  report.input.points = all;
  report.input.duplicates = MergeDuplicates(cloud).duplicates;
  report.input.thinned_to = stayed;
  report.input.box_min = cloud.origin() + cloud.points().rowwise().minCoeff();
  report.input.box_max = cloud.origin() + cloud.points().rowwise().maxCoeff();
  if (options.tolerance) {
    const Eigen::Index out = Summarise(fit.residuals, options.tolerance, left_out).out_of_tolerance;
    if (out > 0) {
      report.warnings.push_back(std::to_string(out) +
                                " points that thinning left out are out of tolerance and are not "
                                "counted (error_all counts them)");
    }
  }
  return fit;
}

}  // namespace

SurfaceFit FitInMemory(const PointCloud& cloud,
                       const SurfaceFitOptions& options,
                       StageClock& clock) {
  if (options.thin) return FitDownsampled(cloud, options, clock);
  if (options.symmetric) return FitSymmetric(cloud, options, clock);
  SurfacePipeline road(cloud, options, clock);
  SurfaceFit fit = road.Fit(options);
  const bool free_knots = options.optimize && options.optimize->knots && !options.given_parameters;
  if (!road.doubted() || !free_knots) return fit;
  return Explained(std::move(fit), road.FitAll(options));
}

}  // namespace batten::internal
