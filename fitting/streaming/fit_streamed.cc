// SPDX-License-Identifier: MIT
#include "batten/fitting/fit_streamed.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "batten/fitting/distances.h"
#include "batten/fitting/fit_surface.h"
#include "batten/fitting/refused_data.h"
#include "batten/fitting/robust_loss.h"
#include "batten/geometry/thread_pool.h"
#include "fitting/cloud/residual_outliers.h"
#include "fitting/core/fit_end.h"
#include "fitting/core/shared_constants.h"
#include "fitting/core/stage_clock.h"
#include "fitting/streaming/distance_counts.h"
#include "fitting/streaming/first_look.h"
#include "fitting/streaming/foot_guesses.h"
#include "fitting/streaming/near_surface.h"
#include "fitting/streaming/place_sums.h"
#include "fitting/surface/fit_over_base.h"
#include "fitting/surface/hold_between_points.h"
#include "fitting/surface/surface_measurement.h"
#include "fitting/surface/surface_overshoot.h"
#include "fitting/surface/surface_postprocess.h"
#include "geometry/numeric/number_text.h"

namespace batten {
using namespace internal;
namespace {

// Bytes a point that FitSurface takes, and bytes a place that this takes with its solution:
// measured as resident memory at 10^7 points, and at 10^6 places.
constexpr std::int64_t kBytesOfPoint = 250, kBytesOfPlace = 600;

constexpr double kPlacesToBegin = 250000;
// Places to a control point: with 40, six along a cell, what the mean of a place hides of a
// difference between surfaces is a hundredth of it (of a wave two cells long); fewer hide more.
constexpr double kPlacesOfControlPoint = 40, kPlacesToAsk = 80;
constexpr int kRounds = 3;
constexpr double kRoomInSpacings = 4;  // of the sample, beyond its edges

// Where the sample has no outliers, points are none up to so many times its greatest distance: that
// of 10^12 normal errors is 1.7 times that of 10^5.
constexpr double kBeyondSample = 4;
constexpr double kMisses = 3, kBeyondStructure = 2, kLeastScale = 1e-3;  // as ClassifyInliers has

// By how much the share of the points beyond the limit is more than the sample's by chance.
constexpr double kStandardErrors = 5;

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

// The prepared cloud of means of places: each is as sure as its points are many.
PreparedCloud PreparedMeans(const NearSurface& near,
                            const PlaceSums::Means& means,
                            const Eigen::Vector3d& origin,
                            double noise,
                            double margin) {
  const auto count = static_cast<Eigen::Index>(means.places.size());
  if (count < 4) throw RefusedData("hardly any point is near the surface of the sample");
  PreparedCloud prepared;
  prepared.merged.cloud = PointCloud(near.PointsOf(means.places), origin);
  Eigen::VectorXd weights(count);
  for (Eigen::Index k = 0; k < count; ++k)
    weights[k] = means.places[static_cast<std::size_t>(k)].count;
  const double mean = weights.mean();
  prepared.merged.cloud.set_weights(weights / mean);
  for (Eigen::Index k = 0; k < count; ++k) prepared.merged.place.push_back(k);
  prepared.base = near.BaseOf(means.places, margin);
  prepared.reached = prepared.used = PointMask::Constant(count, true);
  prepared.statistics.noise = noise / std::sqrt(mean);
  prepared.statistics.outliers = PointMask::Constant(count, false);
  return prepared;
}

// What is measured of all points at the end.
struct AllDistances {
  DistanceCounts used, all;
  double farthest_used = 0;
  Eigen::Vector3d farthest = Eigen::Vector3d::Zero();  // of those used, world
  Eigen::AlignedBox3d beyond = {};                     // of the others
};

class StreamPipeline {
 public:
  StreamPipeline(PointSource& source, const SurfaceFitOptions& options, const StreamOptions& stream)
      : source_(source), options_(options), stream_(stream), pool_(options.threads) {
    plain_ = options;
    plain_.optimize = FreeVariables{};
  }

  StreamedFit Fit() {
    Look();
    if (!source_.shared() &&
        look_.count <= static_cast<double>(stream_.memory) / static_cast<double>(kBytesOfPoint))
      return InMemory();
    NurbsSurface surface = FitSample().draft.surface;
    double places = kPlacesToBegin;
    for (int round = 1;; ++round) {
      const NearSurface near(
          base_, surface, kRoomInSpacings * sample_spacing_, look_.count, sample_.points(), pool_);
      places = std::clamp(places, std::min(kPlacesToBegin, MostPlaces()), MostPlaces());
      Summed(near, places);
      PreparedCloud prepared = PreparedMeans(near, means_, sample_.origin(), noise_, Margin());
      prepared.statistics.spacing = SpacingOfPlaces(prepared);
      clock_.Enter(&StageSeconds::solve);
      FittedState fitted =
          FitOverBase(prepared, OptionsOfPlaces(), StartReport(prepared), pool_, clock_);
      const double unknowns = fitted.draft.surface.size_u() * fitted.draft.surface.size_v();
      coarse_ = static_cast<double>(means_.places.size()) < kPlacesOfControlPoint * unknowns &&
                means_.used > kPlacesOfControlPoint * unknowns;
      const bool finer = coarse_ && places < MostPlaces();
      if (round == kRounds || !(finer || IsFar(near, prepared, fitted.draft)))
        return Measured(prepared, std::move(fitted));
      if (finer) places = kPlacesToAsk * unknowns;
      surface = fitted.draft.surface;
      base_ = std::move(prepared.base);
    }
  }

 private:
  double MostPlaces() const {
    return static_cast<double>(stream_.memory) / static_cast<double>(kBytesOfPlace);
  }

  // A pass, its points relative to the sample's origin.
  void PassLocal(const char* stage, const TakePoints& take) {
    ++passes_;
    double done = 0;
    Report(options_.progress, stage, 0);
    source_.Pass([&](const Eigen::Matrix3Xd& points) {
      take(points.colwise() - sample_.origin());
      done += static_cast<double>(points.cols());
      Report(options_.progress, stage, std::min(1.0, done / look_.count));
    });
  }

  void Look() {
    ++passes_;
    clock_.Enter(&StageSeconds::read);
    look_ = TakeFirstLook(source_, stream_.sample, options_.seed, options_.progress);
    sample_ = PointCloud::FromWorld(look_.sample);
  }

  StreamedFit InMemory() {
    Eigen::Matrix3Xd points(3, static_cast<Eigen::Index>(look_.count));
    Eigen::Index at = 0;
    ++passes_;
    source_.Pass([&](const Eigen::Matrix3Xd& some) {
      if (at + some.cols() > points.cols()) throw PassesDiffer();
      points.middleCols(at, some.cols()) = some;
      at += some.cols();
    });
    if (at != points.cols()) throw PassesDiffer();
    PointCloud cloud = PointCloud::FromWorld(std::move(points));
    SurfaceFit fit = FitSurface(cloud, options_);
    return {std::move(fit.surface),
            std::move(fit.report),
            std::move(cloud),
            std::move(fit.parameters),
            std::move(fit.residuals),
            std::move(fit.outliers),
            true,
            passes_};
  }

  static std::runtime_error PassesDiffer() {
    return std::runtime_error("the source gave other points than in its first pass");
  }

  FittedState FitSample() {
    clock_.Enter(&StageSeconds::prepare);
    SurfaceFitOptions options = plain_;
    options.tolerance.reset();
    const PreparedCloud prepared = PrepareCloud(sample_, options, pool_, clock_);
    base_ = prepared.base;
    warnings_ = prepared.warnings;
    candidates_ = prepared.candidates;
    sample_noise_ = prepared.statistics.noise;
    sample_spacing_ = prepared.statistics.spacing;
    sample_points_ = static_cast<double>(prepared.merged.cloud.size());
    noise_ = sample_noise_;
    return FitOverBase(prepared, options, StartReport(prepared), pool_, clock_);
  }

  double Spacing() const { return sample_spacing_ * std::sqrt(sample_points_ / look_.different); }

  // Beyond the points, as BaseInput has it.
  double Margin() const { return Spacing() / 2 + 2 * noise_; }

  double SpacingOfPlaces(const PreparedCloud& prepared) const {
    return sample_spacing_ *
           std::sqrt(sample_points_ / static_cast<double>(prepared.merged.cloud.size()));
  }

  // The distance at which outliers begin, as the sample tells it: as ClassifyInliers has it, but
  // finite, so that what the sample does not show does not draw the surface away.
  double LimitOf(const Eigen::VectorXd& distances) const {
    if (options_.keep_outliers) return std::numeric_limits<double>::infinity();
    const double scale = options_.loss_scale.value_or(RobustScale(distances));
    const bool misses = scale > kMisses * sample_noise_;
    const double least = std::max({kTukeyTuning * scale,
                                   (misses ? kBeyondStructure : kLeastScale) * sample_spacing_,
                                   options_.tolerance.value_or(0)});
    return std::min(OutlierThreshold(distances, least),
                    std::max(least, kBeyondSample * distances.cwiseAbs().maxCoeff()));
  }

  void Summed(const NearSurface& near, double places) {
    clock_.Enter(&StageSeconds::parameterize);
    limit_ = LimitOf(near.Place(sample_.points(), pool_).distances);
    PlaceSums sums(PlaceGrid::Of(near.low(), near.high(), places));
    PassLocal("parameterize", [&](const Eigen::Matrix3Xd& points) {
      const PlacedPoints placed = near.Place(points, pool_);
      for (Eigen::Index k = 0; k < points.cols(); ++k) {
        const bool beyond = !(std::abs(placed.distances[k]) <= limit_);
        sums.Add(placed.parameters.col(k), placed.offsets[k], beyond);
      }
    });
    source_.Sum(sums.numbers());
    means_ = sums.Collected();
    if (means_.used + means_.set_aside != look_.count) throw PassesDiffer();
    if (means_.variance > 0) noise_ = std::min(sample_noise_, std::sqrt(means_.variance));
  }

  // Whether the surface is so far from the one the points were placed by that what places hide may
  // count against the error of its coefficients: one more round.
  bool IsFar(const NearSurface& near, const PreparedCloud& prepared, const SurfaceState& draft) {
    constexpr double kHidden = 0.01;  // of the difference; see kPlacesOfControlPoint
    constexpr double kCounts = 0.2;   // of the standard error of the surface
    const PlacedPoints placed = near.Place(prepared.merged.cloud.points(), pool_);
    const Eigen::VectorXd now =
        DistancesFrom(
            draft.surface, prepared.merged.cloud.points(), prepared.base.parameters, pool_)
            .distances;
    const double moved =
        (placed.distances - now).norm() / std::sqrt(static_cast<double>(now.size()));
    const double unknowns = draft.surface.size_u() * draft.surface.size_v();
    return kHidden * moved > kCounts * noise_ * std::sqrt(unknowns / means_.used);
  }

  // Over places every outlier is gone. Means must keep what noise leaves of the tolerance: the
  // greatest of m normal errors is about √(2 ln m) of them; where that is more, it can't be kept.
  SurfaceFitOptions OptionsOfPlaces() const {
    SurfaceFitOptions options = plain_;
    options.keep_outliers = true;
    options.loss = Loss::kNone;
    if (!options.tolerance) return options;
    constexpr double kLeastShare = 1.0 / 3;
    const double noise = noise_ * std::sqrt(2 * std::log(look_.count));
    if (*options.tolerance > noise)
      options.tolerance = std::max(*options.tolerance - noise, kLeastShare * *options.tolerance);
    return options;
  }

  FitReport StartReport(const PreparedCloud& prepared) const {
    FitReport report;
    report.threads = pool_.threads();
    report.input = SummariseInput(prepared.merged.cloud, 0, prepared.statistics);
    report.geometry.base = prepared.base.name;
    report.geometry.base_why = prepared.base.why;
    if (prepared.base.plane) report.geometry.base_axes = prepared.base.plane->axes;
    report.warnings = warnings_;
    report.base_candidates = candidates_;
    return report;
  }

  StreamedFit Measured(const PreparedCloud& prepared, FittedState fitted) {
    const SurfaceFitOptions options = OptionsOfPlaces();
    clock_.Enter(&StageSeconds::trim);
    TrimToUsed(fitted, prepared, options, pool_);
    if (options.trim != Trimming::kNone) {
      HoldBetweenPoints(fitted.draft,
                        prepared.statistics.spacing,
                        DirectionOfHeights(fitted.report),
                        options.tolerance,
                        pool_);
    }
    clock_.Enter(&StageSeconds::project);
    const EndCode search = fitted.report.end.code;
    SurfaceFit fit = MeasureFit(fitted.draft.surface,
                                prepared.merged.cloud,
                                prepared.merged,
                                fitted.used,
                                options,
                                prepared.base.shape,
                                pool_,
                                std::move(fitted.report),
                                nullptr,
                                &fitted.draft.parameters);
    const NurbsSurface local = fit.surface.Translated(options_.shift - sample_.origin());
    AllDistances all = MeasureAll(local, prepared.base);
    StreamedFit result{std::move(fit.surface), std::move(fit.report), sample_, {}, {}, {}};
    result.parameters = std::move(of_sample_.parameters);
    result.residuals = std::move(of_sample_.distances);
    result.outliers = result.residuals.array().abs() > limit_;
    Complete(all, search, result);
    result.passes = passes_;
    return result;
  }

  AllDistances MeasureAll(const NurbsSurface& surface, const Parameterization& base) {
    const double unit = (look_.high - look_.low).norm();
    AllDistances all{DistanceCounts(unit, options_.tolerance),
                     DistanceCounts(unit, options_.tolerance)};
    std::optional<SurfaceDistances> over_plane;
    std::optional<FootGuesses> guesses;
    const Eigen::Matrix3Xd& sample = sample_.points();
    if (base.plane) {
      const Eigen::Matrix2Xd near = base.plane->ToFrame(sample).topRows<2>();
      over_plane.emplace(surface, look_.count, sample, near, pool_);
      of_sample_ = over_plane->To(sample, near, pool_);
    } else {
      guesses.emplace(surface, look_.count, sample, pool_);
      of_sample_ = guesses->of_sample();
    }
    PassLocal("project", [&](const Eigen::Matrix3Xd& points) {
      const PointDistances found =
          base.plane ? over_plane->To(points, base.plane->ToFrame(points).topRows<2>(), pool_)
                     : guesses->DistancesOf(points, pool_);
      for (Eigen::Index k = 0; k < points.cols(); ++k) {
        const double distance = found.distances[k];
        all.all.Add(distance);
        if (std::abs(distance) > limit_) {
          all.beyond.extend(points.col(k) + sample_.origin());
          continue;
        }
        all.used.Add(distance);
        if (std::abs(distance) < all.farthest_used) continue;
        all.farthest_used = std::abs(distance);
        all.farthest = points.col(k) + sample_.origin();
      }
    });
    Merge(all);
    return all;
  }

  // With what other processes have measured.
  void Merge(AllDistances& all) {
    source_.Sum(all.used.numbers());
    source_.Sum(all.all.numbers());
    const Eigen::Vector3d &at = all.farthest, &low = all.beyond.min(), &high = all.beyond.max();
    const std::vector<double> own = {all.used.greatest(),
                                     all.all.greatest(),
                                     at[0],
                                     at[1],
                                     at[2],
                                     low[0],
                                     low[1],
                                     low[2],
                                     high[0],
                                     high[1],
                                     high[2]};
    const std::size_t size = own.size();
    const std::vector<double> every = source_.Gathered(own);
    for (std::size_t k = 0; k < every.size(); k += size) {
      const double* one = every.data() + k;
      if (one[0] > all.used.greatest()) all.farthest = Eigen::Vector3d(one[2], one[3], one[4]);
      all.used.set_greatest(std::max(all.used.greatest(), one[0]));
      all.all.set_greatest(std::max(all.all.greatest(), one[1]));
      if (one[5] > one[8]) continue;  // an empty box
      all.beyond.extend(Eigen::Vector3d(one[5], one[6], one[7]));
      all.beyond.extend(Eigen::Vector3d(one[8], one[9], one[10]));
    }
  }

  void Complete(const AllDistances& all, EndCode search, StreamedFit& result) {
    FitReport& report = result.report;
    const bool structured = report.end.code == EndCode::kStructuredResiduals;
    report.error = all.used.Summary();
    report.error_all = all.all.Summary();
    InputSummary& input = report.input;
    input.points = static_cast<Eigen::Index>(look_.count);
    input.used = report.error.points;
    input.outliers = input.points - input.used;
    input.spacing = Spacing();
    input.noise = noise_;
    input.origin = sample_.origin();
    input.box_min = look_.low;
    input.box_max = look_.high;
    report.optimize.why = "the points are not in memory: free parameters need them there";
    EndEvidence evidence;
    evidence.search = search;
    evidence.control_points_given = options_.control_points.has_value();
    evidence.noise = noise_;
    evidence.rounding = 1e-9 * (look_.high - look_.low).norm();
    evidence.structured = structured;
    evidence.farthest = all.farthest;
    JudgeEnd(evidence, report);
    if (coarse_) {
      report.warnings.push_back(
          "in the memory allowed, places are few for so many control points: detail within them is "
          "averaged; more memory follows it");
    }
    WarnOfWhatTheSampleMisses(all, result);
    report.seconds = clock_.Seconds();
  }

  void WarnOfWhatTheSampleMisses(const AllDistances& all, StreamedFit& result) const {
    const double beyond = static_cast<double>(result.report.input.outliers) / look_.count;
    const auto size = static_cast<double>(result.outliers.size());
    const double of_sample = static_cast<double>(result.outliers.count()) / size;
    if (beyond <= of_sample + kStandardErrors * std::sqrt(of_sample / size)) return;
    const auto corner = [](const Eigen::Vector3d& at) {
      return "(" + RoundedText(at[0]) + ", " + RoundedText(at[1]) + ", " + RoundedText(at[2]) + ")";
    };
    result.report.warnings.push_back(
        std::to_string(result.report.input.outliers) + " points, " + Percent(beyond) +
        ", are farther than " + RoundedText(limit_) + " from the surface, where the sample has " +
        Percent(of_sample) + ": it may miss a part; they are between " + corner(all.beyond.min()) +
        " and " + corner(all.beyond.max()) + "; a larger sample may have it");
  }

  PointSource& source_;
  const SurfaceFitOptions& options_;
  const StreamOptions& stream_;
  SurfaceFitOptions plain_;
  ThreadPool pool_;
  StageClock clock_;
  FirstLook look_;
  PointCloud sample_;
  Parameterization base_;
  std::vector<std::string> warnings_;
  std::vector<BaseCandidate> candidates_;
  PlaceSums::Means means_;
  PointDistances of_sample_;  // from the surface, at the end
  double sample_noise_ = 0, sample_spacing_ = 0, sample_points_ = 0;
  double noise_ = 0, limit_ = 0;
  bool coarse_ = false;  // fewer places to a control point than the means of places ask for
  int passes_ = 0;
};

}  // namespace

void Check(const StreamOptions& options) {
  if (options.memory < std::int64_t{1} << 25)
    throw std::invalid_argument("memory: " + std::to_string(options.memory) +
                                " bytes are too few; at least 32 MiB are needed");
  if (options.sample < 1000)
    throw std::invalid_argument("sample: " + std::to_string(options.sample) +
                                " points are too few; at least 1000 are needed");
}

StreamedFit FitStreamed(PointSource& source,
                        const SurfaceFitOptions& options,
                        const StreamOptions& stream) {
  Check(options);
  Check(stream);
  RefuseWhatNeedsAllPoints(options);
  return StreamPipeline(source, options, stream).Fit();
}

}  // namespace batten
