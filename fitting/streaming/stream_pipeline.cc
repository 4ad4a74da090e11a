// SPDX-License-Identifier: MIT
#include "fitting/streaming/stream_pipeline.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "batten/fitting/distances.h"
#include "batten/fitting/refused_data.h"
#include "fitting/core/fit_end.h"
#include "fitting/core/shared_constants.h"
#include "fitting/streaming/sample_warnings.h"
#include "fitting/surface/hold_between_points.h"
#include "fitting/surface/surface_overshoot.h"
#include "fitting/surface/surface_postprocess.h"

namespace batten::internal {
namespace {

// Places to a control point: with 40, six along a cell, what the mean of a place hides of a
// difference between surfaces is a hundredth of it (of a wave two cells long); fewer hide more.
constexpr double kPlacesOfControlPoint = 40, kPlacesToAsk = 80;
constexpr int kRounds = 3;

// The prepared cloud of means of places: each is as sure as its points are many.
PreparedCloud PreparedMeans(const NearSurface& near,
                            const PlaceSums::Means& means,
                            const SampleFit& sample,
                            double noise,
                            double margin) {
  const auto count = static_cast<Eigen::Index>(means.places.size());
  if (count < kFewestSurfacePoints)
    throw RefusedData("hardly any point is near the surface of the sample");
  PreparedCloud prepared;
  prepared.merged.cloud = PointCloud(near.PointsOf(means.places), sample.cloud.origin());
  Eigen::VectorXd weights(count);
  for (Eigen::Index k = 0; k < count; ++k)
    weights[k] = means.places[static_cast<std::size_t>(k)].count;
  const double mean = weights.mean();
  prepared.merged.cloud.set_weights(weights / mean);
  for (Eigen::Index k = 0; k < count; ++k) prepared.merged.place.push_back(k);
  prepared.base = near.BaseOf(means.places, margin);
  prepared.reached = prepared.used = PointMask::Constant(count, true);
  prepared.statistics.noise = noise / std::sqrt(mean);
  prepared.statistics.spacing = sample.SpacingOf(static_cast<double>(count));
  prepared.statistics.outliers = PointMask::Constant(count, false);
  prepared.warnings = sample.warnings;
  prepared.candidates = sample.candidates;
  return prepared;
}

double Unknowns(const NurbsSurface& surface) {
  return static_cast<double>(surface.size_u()) * surface.size_v();
}

}  // namespace

std::optional<double> ToleranceOfShape(const std::optional<double>& tolerance,
                                       double noise,
                                       double count) {
  if (!tolerance) return std::nullopt;
  constexpr double kLeastShare = 1.0 / 3;
  const double greatest = noise * std::sqrt(2 * std::log(count));
  return *tolerance > greatest ? std::max(*tolerance - greatest, kLeastShare * *tolerance)
                               : *tolerance;
}

void RefuseWhatNeedsAllPoints(const SurfaceFitOptions& options) {
  const auto refuse = [](const char* field) {
    throw std::invalid_argument(std::string(field) +
                                ": needs all points in memory; points that are passed over are "
                                "fitted without it");
  };
  if (!options.boundary.empty()) refuse("boundary");
  if (options.meet) refuse("meet");
  if (options.symmetric) refuse("symmetric");
  if (options.domain) refuse("domain");
  if (options.thin) refuse("thin");
  if (options.snap) refuse("snap");
  if (options.optimize && options.optimize->any()) refuse("optimize");
  if (options.terms) refuse("terms");
  if (options.given_parameters) refuse("given_parameters");
  if (options.side_of_normals) refuse("side_of_normals");
  if (options.smooth_by != SmoothBy::kWeight) refuse("smooth_by");
}

StreamPipeline::StreamPipeline(PointPasses& passes,
                               const SurfaceFitOptions& options,
                               const StreamLimits& limits,
                               FirstLook look,
                               ThreadPool& pool,
                               StageClock& clock)
    : passes_(passes),
      options_(options),
      limits_(limits),
      look_(std::move(look)),
      pool_(pool),
      clock_(clock),
      sample_(FitSample(look_, options, pool, clock)) {}

void StreamPipeline::Pass(const char* stage,
                          const std::vector<std::span<double>>& numbers,
                          const TakePoints& take,
                          const std::function<void()>& merge) {
  passes_.Next(numbers, [&] {
    double done = 0;
    passes_.Over([&](const Eigen::Matrix3Xd& points) {
      take(points);
      done += static_cast<double>(points.cols());
      const double share = std::min(1.0, done / look_.count);
      if (limits_.stops_in_passes) {
        Report(options_.progress, stage, share);
      } else if (options_.progress) {
        options_.progress(stage, share);
      }
    });
    merge();
  });
}

Eigen::Matrix3Xd StreamPipeline::Local(const Eigen::Matrix3Xd& points) const {
  return points.colwise() - sample_.cloud.origin();
}

PlacedSums StreamPipeline::Summed(const NearSurface& near, double places) {
  clock_.Enter(&StageSeconds::parameterize);
  const double limit =
      sample_.LimitOf(near.Place(sample_.cloud.points(), pool_).distances, options_);
  PlaceSums sums(PlaceGrid::Of(near.low(), near.high(), places));
  const auto add = [&](const Eigen::Matrix3Xd& points) {
    const PlacedPoints placed = near.Place(Local(points), pool_);
    for (Eigen::Index k = 0; k < points.cols(); ++k) {
      const bool beyond = !(std::abs(placed.distances[k]) <= limit);
      sums.Add(placed.parameters.col(k), placed.offsets[k], beyond);
    }
  };
  Pass("parameterize", {sums.numbers()}, add, [&] { source().Sum(sums.numbers()); });
  PlaceSums::Means means = sums.Collected();
  if (means.used + means.set_aside != look_.count)
    throw std::runtime_error("the source gave other points than in its first pass");
  double noise = sample_.noise;
  if (means.variance > 0) noise = std::min(noise, std::sqrt(means.variance));
  return {std::move(means), noise, limit};
}

// Whether the surface is so far from the one the points were placed by that what places hide may
// count against the error of its coefficients: one more round.
bool StreamPipeline::IsFar(const NearSurface& near, const PlacesFit& fit) {
  constexpr double kHidden = 0.01;  // of the difference; see kPlacesOfControlPoint
  constexpr double kCounts = 0.2;   // of the standard error of the surface
  const Eigen::Matrix3Xd& means = fit.prepared.merged.cloud.points();
  const NurbsSurface& surface = fit.fitted.draft.surface;
  const PlacedPoints placed = near.Place(means, pool_);
  const Eigen::VectorXd now =
      DistancesFrom(surface, means, fit.prepared.base.parameters, pool_).distances;
  const double moved = (placed.distances - now).norm() / std::sqrt(static_cast<double>(now.size()));
  return kHidden * moved >
         kCounts * fit.sums.noise * std::sqrt(Unknowns(surface) / fit.sums.means.used);
}

// Over places every outlier is gone. Means must keep what noise leaves of the tolerance.
SurfaceFitOptions StreamPipeline::OptionsOfPlaces(double noise) const {
  SurfaceFitOptions options = options_;
  options.keep_outliers = true;
  options.loss = Loss::kNone;
  options.tolerance = ToleranceOfShape(options.tolerance, noise, look_.count);
  return options;
}

PlacesFit StreamPipeline::Solve() {
  Parameterization base = sample_.base;
  NurbsSurface surface = sample_.surface;
  double places = limits_.first_places;
  for (int round = 1;; ++round) {
    const NearSurface near(base,
                           surface,
                           kRoomInSpacings * sample_.spacing,
                           look_.count,
                           sample_.cloud.points(),
                           pool_);
    places = std::clamp(
        places, std::min(limits_.first_places, limits_.most_places), limits_.most_places);
    PlacedSums sums = Summed(near, places);
    // Beyond the points, as BaseInput has it.
    const double margin = sample_.SpacingOf(look_.different) / 2 + 2 * sums.noise;
    PreparedCloud prepared = PreparedMeans(near, sums.means, sample_, sums.noise, margin);
    clock_.Enter(&StageSeconds::solve);
    FittedState fitted =
        FitOverBase(prepared,
                    OptionsOfPlaces(sums.noise),
                    StartReport(prepared, prepared.merged.cloud, 0, pool_.threads()),
                    pool_,
                    clock_);
    const double unknowns = Unknowns(fitted.draft.surface);
    const auto held = static_cast<double>(sums.means.places.size());
    const bool coarse = held < kPlacesOfControlPoint * unknowns &&
                        sums.means.used > kPlacesOfControlPoint * unknowns;
    PlacesFit fit{std::move(prepared), std::move(fitted), std::move(sums), coarse};
    const bool finer = coarse && places < limits_.most_places;
    if (round == kRounds || !(finer || IsFar(near, fit))) {
      Trim(fit);
      return fit;
    }
    if (finer) places = kPlacesToAsk * unknowns;
    surface = fit.fitted.draft.surface;
    base = std::move(fit.prepared.base);
  }
}

void StreamPipeline::Trim(PlacesFit& fit) {
  clock_.Enter(&StageSeconds::trim);
  const SurfaceFitOptions options = OptionsOfPlaces(fit.sums.noise);
  TrimToUsed(fit.fitted, fit.prepared, options, pool_);
  if (options.trim == Trimming::kNone) return;
  HoldBetweenPoints(fit.fitted.draft,
                    fit.prepared.statistics.spacing,
                    DirectionOfHeights(fit.fitted.report),
                    options.tolerance,
                    options.progress,
                    pool_);
}

StreamedFit StreamPipeline::Measured(PlacesFit places, const TakeDistances& take) {
  clock_.Enter(&StageSeconds::project);
  FittedState& fitted = places.fitted;
  const EndCode search = fitted.report.end.code;
  SurfaceFit fit = MeasureFit(fitted.draft.surface,
                              places.prepared.merged.cloud,
                              places.prepared.merged,
                              fitted.used,
                              OptionsOfPlaces(places.sums.noise),
                              places.prepared.base.shape,
                              pool_,
                              std::move(fitted.report),
                              nullptr,
                              &fitted.draft.parameters);
  return Measured(UnmeasuredFit{std::move(fit.surface),
                                std::move(fit.report),
                                std::move(places.prepared.base),
                                places.sums.noise,
                                places.sums.limit,
                                search,
                                places.coarse},
                  take);
}

StreamedFit StreamPipeline::Measured(UnmeasuredFit fit, const TakeDistances& take) {
  clock_.Enter(&StageSeconds::project);
  const DistanceMeter meter(fit.surface.Translated(options_.shift - sample_.cloud.origin()),
                            fit.base,
                            look_.count,
                            sample_.cloud.points(),
                            pool_);
  AllDistances all((look_.high - look_.low).norm(), options_.tolerance, fit.limit);
  AllDistances::Extremes extremes{};
  std::vector<std::span<double>> numbers = {all.used.numbers(), all.all.numbers(), extremes};
  numbers.insert(numbers.end(), take.numbers.begin(), take.numbers.end());
  const auto measure = [&](const Eigen::Matrix3Xd& points) {
    const PointDistances found = meter.Of(Local(points), pool_);
    all.Add(points, found.distances);
    if (take.take) take.take(found);
  };
  Pass("project", numbers, measure, [&] {
    all.Merge(source());
    extremes = all.extremes();
    if (take.merge) take.merge();
  });
  all.set_extremes(extremes);
  StreamedFit result{.surface = std::move(fit.surface),
                     .report = std::move(fit.report),
                     .sample = sample_.cloud,
                     .parameters = meter.of_sample().parameters,
                     .residuals = meter.of_sample().distances,
                     .outliers = meter.of_sample().distances.array().abs() > fit.limit};
  Complete(fit, all, result);
  result.passes = passes_.done();
  return result;
}

void StreamPipeline::Complete(const UnmeasuredFit& fit,
                              const AllDistances& all,
                              StreamedFit& result) const {
  FitReport& report = result.report;
  const bool structured = report.end.code == EndCode::kStructuredResiduals;
  report.error = all.used.Summary();
  report.error_all = all.all.Summary();
  InputSummary& input = report.input;
  input.points = static_cast<Eigen::Index>(look_.count);
  input.used = report.error.points;
  input.outliers = input.points - input.used;
  input.spacing = sample_.SpacingOf(look_.different);
  input.noise = fit.noise;
  input.origin = sample_.cloud.origin();
  input.box_min = look_.low;
  input.box_max = look_.high;
  report.optimize.why = "the points are not in memory: free parameters need them there";
  EndEvidence evidence;
  evidence.search = fit.search;
  evidence.control_points_given = options_.control_points.has_value();
  evidence.noise = fit.noise;
  evidence.rounding = 1e-9 * (look_.high - look_.low).norm();
  evidence.structured = structured;
  evidence.farthest = all.farthest;
  JudgeEnd(evidence, report);
  if (fit.coarse) {
    report.warnings.push_back(
        "in the memory allowed, places are few for so many control points: detail within them is "
        "averaged; more memory follows it");
  }
  WarnOfWhatTheSampleMisses(all, look_.count, result.outliers, report);
  report.seconds = clock_.Seconds();
}

}  // namespace batten::internal
