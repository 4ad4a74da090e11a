// SPDX-License-Identifier: MIT
#include "batten/fitting/fit_tiles.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>

#include "batten/fitting/distances.h"
#include "batten/fitting/refused_data.h"
#include "batten/fitting/trim_to_points.h"
#include "batten/geometry/split.h"
#include "fitting/core/box_excursion.h"
#include "fitting/core/rounding.h"
#include "fitting/core/shared_constants.h"
#include "fitting/streaming/sample_warnings.h"
#include "fitting/streaming/stream_pipeline.h"
#include "fitting/tiles/tile_levels.h"
#include "fitting/tiles/tile_points.h"
#include "geometry/numeric/number_text.h"

namespace batten {
using namespace internal;
namespace {

constexpr double kPointsToCell = 4;   // of the finest net: fewer, and cross-validation is blind
constexpr double kCellsOfTile = 128;  // of the finest net along a tile whose number is chosen
constexpr int kCoarsestCells = 4;     // along a tile on the coarsest level, at least
constexpr int kMostLevels = 5;
constexpr int kMostOfSample = 5000;  // control points of the surface near all points
constexpr int kPassesForTolerance = 3;
constexpr double kEmptyToTell = 0.05;  // share of the cells without points

SurfaceFitOptions OptionsOfSample(const SurfaceFitOptions& options) {
  SurfaceFitOptions plain = options;
  plain.optimize = FreeVariables{};
  plain.control_points.reset();
  plain.max_control_points = std::min(options.max_control_points, kMostOfSample);
  if (plain.closed == Closing::kAuto) plain.closed = Closing::kNone;
  return plain;
}

void RequireOpen(const Parameterization& base) {
  if (base.periodic_u || base.periodic_v || base.sharp_edge || base.poles.any())
    throw RefusedData("the points close on themselves (base " + base.name +
                      "): tiles are of open sheets");
}

struct TileAxes {
  TileAxis u, v;
};

std::string Sizes(int u, int v) { return std::to_string(u) + " x " + std::to_string(v); }

TileAxes AxesOf(const Parameterization& base,
                double points,
                const SurfaceFitOptions& options,
                const TileOptions& tiles) {
  const int p = options.degree_u, q = options.degree_v;
  const double ratio = base.length_u / base.length_v;
  const double most = std::min<double>(options.max_control_points, points / kPointsToCell);
  const auto cells = [&](double wanted, int degree) {
    return std::max(1, static_cast<int>(std::floor(wanted)) - degree);
  };
  int cells_u = cells(std::sqrt(most * ratio), p), cells_v = cells(std::sqrt(most / ratio), q);
  if (options.control_points) {
    RequireDataFor(options, static_cast<Eigen::Index>(points));
    cells_u = options.control_points->first - p;
    cells_v = options.control_points->second - q;
  }
  const auto chosen = [](int count, int of) {
    return count > 0 ? count : std::max(1, static_cast<int>(std::lround(of / kCellsOfTile)));
  };
  const int count_u = chosen(tiles.count_u, cells_u), count_v = chosen(tiles.count_v, cells_v);
  if (count_u > cells_u || count_v > cells_v)
    throw RefusedData(Sizes(count_u, count_v) + " tiles are more than the " +
                      Sizes(cells_u, cells_v) + " cells that " +
                      (options.control_points ? "so many control points have"
                                              : "so many points allow, four to a cell") +
                      ": fewer tiles can be had");
  if (options.control_points)
    return {{base.length_u, count_u, cells_u}, {base.length_v, count_v, cells_v}};
  const int of_tile = std::min(cells_u / count_u, cells_v / count_v);
  int level = 0;
  while (level < kMostLevels && (of_tile >> (level + 1)) >= kCoarsestCells) ++level;
  const auto axis = [&](double length, int count, int cells) {
    return TileAxis(length, count, (count * ((cells / count) >> level)) << level, level);
  };
  return {axis(base.length_u, count_u, cells_u), axis(base.length_v, count_v, cells_v)};
}

// Numbers of the points of each tile, as they are measured.
class TileMeter {
 public:
  TileMeter(const TileAxes& axes, double limit, std::optional<double> tolerance)
      : axes_(axes),
        limit_(limit),
        tolerance_(tolerance.value_or(std::numeric_limits<double>::infinity())),
        numbers_(static_cast<std::size_t>(axes.u.strips() * axes.v.strips() * kNumbers)),
        greatest_(static_cast<std::size_t>(axes.u.strips() * axes.v.strips())) {}

  void Add(const PointDistances& found) {
    for (Eigen::Index k = 0; k < found.distances.size(); ++k) {
      const int tile = axes_.u.StripOf(found.parameters(0, k)) * axes_.v.strips() +
                       axes_.v.StripOf(found.parameters(1, k));
      const double size = std::abs(found.distances[k]);
      double* numbers = numbers_.data() + tile * kNumbers;
      if (size > limit_) {
        numbers[kFar] += 1;
        continue;
      }
      numbers[kCount] += 1;
      numbers[kSquares] += size * size;
      numbers[kOut] += size > tolerance_;
      greatest_[tile] = std::max(greatest_[tile], size);
    }
  }

  std::vector<std::span<double>> numbers() { return {numbers_, greatest_}; }

  void Merge(PointSource& source) {
    source.Sum(numbers_);
    const std::size_t count = greatest_.size();
    const std::vector<double> all = source.Gathered(greatest_);
    for (std::size_t k = 0; k < all.size(); ++k)
      greatest_[k % count] = std::max(greatest_[k % count], all[k]);
  }

  Eigen::ArrayXX<bool> Out() const {
    Eigen::ArrayXX<bool> out(axes_.u.strips(), axes_.v.strips());
    for (Eigen::Index i = 0; i < out.rows(); ++i) {
      for (Eigen::Index j = 0; j < out.cols(); ++j)
        out(i, j) = numbers_[(i * out.cols() + j) * kNumbers + kOut] > 0;
    }
    return out;
  }

  std::vector<TileSummary> Summaries(const NurbsSurface& surface) const {
    const std::vector<double> u = axes_.u.Breaks(), v = axes_.v.Breaks();
    std::vector<TileSummary> tiles;
    for (int i = 0; i < axes_.u.strips(); ++i) {
      for (int j = 0; j < axes_.v.strips(); ++j) {
        const std::size_t at = tiles.size();
        const double* numbers = numbers_.data() + at * kNumbers;
        TileSummary tile;
        tile.u = i;
        tile.v = j;
        tile.low = {u[i], v[j]};
        tile.high = {u[i + 1], v[j + 1]};
        tile.points = static_cast<Eigen::Index>(numbers[kCount]);
        tile.outliers = static_cast<Eigen::Index>(numbers[kFar]);
        tile.out_of_tolerance = static_cast<Eigen::Index>(numbers[kOut]);
        tile.control_points_u = ControlPoints(surface.basis_u(), u[i], u[i + 1]);
        tile.control_points_v = ControlPoints(surface.basis_v(), v[j], v[j + 1]);
        tile.rms = numbers[kCount] > 0 ? std::sqrt(numbers[kSquares] / numbers[kCount]) : 0;
        tile.max = greatest_[at];
        tiles.push_back(tile);
      }
    }
    return tiles;
  }

 private:
  enum { kCount, kSquares, kOut, kFar, kNumbers };

  // Of the face over [a, b], at whose ends knots are inserted.
  static int ControlPoints(const SplineBasis& basis, double a, double b) {
    return basis.Span(std::nextafter(b, a)) - basis.Span(a) + 1 + basis.degree();
  }

  const TileAxes& axes_;
  double limit_, tolerance_;
  std::vector<double> numbers_, greatest_;
};

// The passes of a fit in order.
class TilePipeline {
 public:
  TilePipeline(PointSource& source,
               const SurfaceFitOptions& options,
               const TileOptions& tiles,
               ThreadPool& pool,
               StageClock& clock)
      : passes_(source, tiles.store, options.threads != 1),
        options_(options),
        pool_(pool),
        clock_(clock),
        pipeline_(passes_,
                  OptionsOfSample(options),
                  StreamLimits{0, 0, true},
                  TakeFirstLook(passes_, tiles.sample, options.seed, options.progress),
                  pool,
                  clock) {
    RequireOpen(pipeline_.sample().base);
    clock_.Enter(&StageSeconds::parameterize);
    near_ = NearTo(pipeline_.sample().base, pipeline_.sample().surface);
    domain_ = std::make_unique<TileDomain>(FindDomain(pipeline_, *near_, options_, pool_));
    axes_ =
        std::make_unique<TileAxes>(AxesOf(domain_->base, pipeline_.look().count, options_, tiles));
  }

  TiledFit Fit() {
    TileNet net = Search();
    if (!domain_->base.plane) {
      // Once more, for the points' feet on the surface itself.
      near_ = NearTo(domain_->base, SurfaceOf(net));
      domain_->shift.setZero();
      net = Search();
    }
    for (int pass = 1;; ++pass) {
      TileMeter meter(*axes_, domain_->limit, options_.tolerance);
      TiledFit fit = Measured(net, meter);
      if (pass == kPassesForTolerance || !options_.tolerance || !search_->Refine(meter.Out()))
        return fit;
      clock_.Enter(&StageSeconds::refine);
      net = search_->Solved();
    }
  }

 private:
  std::unique_ptr<NearSurface> NearTo(const Parameterization& base, const NurbsSurface& surface) {
    return std::make_unique<NearSurface>(base,
                                         surface,
                                         kRoomInSpacings * pipeline_.sample().spacing,
                                         pipeline_.look().count,
                                         pipeline_.sample().cloud.points(),
                                         pool_);
  }

  NurbsSurface SurfaceOf(const TileNet& net) const {
    return domain_->base.Surface(net.basis_u, net.basis_v, net.rows.transpose());
  }

  // Folds the points and finds the net that they want.
  TileNet Search() {
    search_.reset();
    clock_.Enter(&StageSeconds::parameterize);
    folded_ = std::make_unique<FoldedPoints>(
        FoldPoints(pipeline_,
                   *near_,
                   *domain_,
                   axes_->u.Basis(options_.degree_u, axes_->u.finest_level()),
                   axes_->v.Basis(options_.degree_v, axes_->v.finest_level()),
                   pool_));
    clock_.Enter(&StageSeconds::solve);
    search_ = std::make_unique<TileSearch>(
        *folded_,
        axes_->u,
        axes_->v,
        TileSearchOptions{
            options_.smoothing.value_or(kSurfaceSmoothing),
            ToleranceOfShape(options_.tolerance, pipeline_.sample().noise, pipeline_.look().count),
            options_.progress},
        pool_);
    return search_->Solved();
  }

  TiledFit Measured(const TileNet& net, TileMeter& meter) {
    FitReport report = StartReport(net);
    const NurbsSurface local = Trimmed(SurfaceOf(net), net, report);
    NurbsSurface written = local.Translated(pipeline_.sample().cloud.origin() - options_.shift);
    EnterExcursion(written,
                   Eigen::AlignedBox3d(pipeline_.look().low - options_.shift,
                                       pipeline_.look().high - options_.shift),
                   options_.shift,
                   report);
    if (report.overshoot) report.overshoot->asked_for = options_.trim == Trimming::kNone;
    const double found = search_->noise();
    const double noise =
        found > 0 ? std::min(pipeline_.sample().noise, found) : pipeline_.sample().noise;
    StreamedFit fit = pipeline_.Measured(
        UnmeasuredFit{
            std::move(written), std::move(report), domain_->base, noise, domain_->limit, End()},
        {[&](const PointDistances& distances) { meter.Add(distances); },
         [&] { meter.Merge(passes_.source()); },
         meter.numbers()});
    fit.report.tiles = meter.Summaries(fit.surface);
    fit.report.geometry.distortion = DistortionAt(fit.surface, fit.parameters);
    WarnOfExcursion(fit.report);
    return {std::move(fit), axes_->u.Breaks(), axes_->v.Breaks()};
  }

  EndCode End() const {
    if (options_.control_points) return EndCode::kMaxControlPoints;
    if (!search_->limited()) return EndCode::kCrossValidated;
    const double by_points = pipeline_.look().count / kPointsToCell;
    return by_points < options_.max_control_points ? EndCode::kDetailBelowSpacing
                                                   : EndCode::kMaxControlPoints;
  }

  FitReport StartReport(const TileNet& net) const {
    const SampleFit& sample = pipeline_.sample();
    FitReport report;
    report.threads = pool_.threads();
    report.geometry.kind = "surface";
    report.geometry.base = sample.base.name;
    report.geometry.base_why = sample.base.why;
    if (sample.base.plane) report.geometry.base_axes = sample.base.plane->axes;
    report.geometry.degree = {options_.degree_u, options_.degree_v};
    report.geometry.control_points = {net.basis_u.size(), net.basis_v.size()};
    report.geometry.closed = {false, false};
    report.geometry.poles = {false, false};
    report.base_candidates = sample.candidates;
    report.iterations = search_->rounds();
    report.warnings = sample.warnings;
    if (net.regularised)
      report.warnings.push_back(
          "the points do not determine every control point: fairness was raised");
    if (net.residual > kRelativelyEqual)
      report.warnings.push_back("the equations hold to " + RoundedText(net.residual) +
                                " of their right-hand side only: parts without points are large");
    return report;
  }

  // Cut back to the sample's outline where tiles are partly empty, if that is asked for.
  NurbsSurface Trimmed(NurbsSurface surface, const TileNet& net, FitReport& report) {
    const double empty = 1 - static_cast<double>((net.errors.weights > 0).count()) /
                                 static_cast<double>(net.errors.weights.size());
    if (empty <= kEmptyToTell) return surface;
    if (options_.trim == Trimming::kNone) {
      report.warnings.push_back("there are no points in " + Percent(empty) +
                                " of the surface: it is a guess there");
      return surface;
    }
    clock_.Enter(&StageSeconds::trim);
    const SampleFit& sample = pipeline_.sample();
    const PlacedPoints placed = near_->Place(sample.cloud.points(), pool_);
    Eigen::Matrix2Xd feet(2, placed.parameters.cols());
    Eigen::Index used = 0;
    for (Eigen::Index k = 0; k < feet.cols(); ++k) {
      if (std::abs(placed.distances[k]) <= domain_->limit)
        feet.col(used++) = placed.parameters.col(k) - domain_->shift;
    }
    feet.conservativeResize(2, used);
    PointTrim trim = TrimToPoints(surface, feet, {}, sample.spacing, sample.noise, pool_);
    report.geometry.trims = static_cast<int>(trim.surface.trims().size());
    report.warnings.insert(report.warnings.end(), trim.warnings.begin(), trim.warnings.end());
    return std::move(trim.surface);
  }

  PointPasses passes_;
  const SurfaceFitOptions options_;
  ThreadPool& pool_;
  StageClock& clock_;
  StreamPipeline pipeline_;
  std::unique_ptr<NearSurface> near_;
  std::unique_ptr<TileDomain> domain_;
  std::unique_ptr<TileAxes> axes_;
  std::unique_ptr<FoldedPoints> folded_;
  std::unique_ptr<TileSearch> search_;
};

// The pieces of a surface between breaks.
std::vector<NurbsSurface> Cut(const NurbsSurface& surface,
                              Direction direction,
                              const std::vector<double>& breaks) {
  std::vector<NurbsSurface> pieces;
  if (surface.trimmed()) {
    for (std::size_t k = 0; k + 1 < breaks.size(); ++k) {
      for (NurbsSurface& part : SegmentParts(surface, direction, breaks[k], breaks[k + 1]))
        pieces.push_back(std::move(part));
    }
    return pieces;
  }
  NurbsSurface rest = surface;
  for (std::size_t k = 1; k + 1 < breaks.size(); ++k) {
    auto [below, above] = Split(rest, direction, breaks[k]);
    pieces.push_back(std::move(below));
    rest = std::move(above);
  }
  pieces.push_back(std::move(rest));
  return pieces;
}

}  // namespace

TiledFit FitTiles(PointSource& source, const SurfaceFitOptions& options, const TileOptions& tiles) {
  Check(options);
  Check(tiles);
  RefuseWhatNeedsAllPoints(options);
  StageClock clock(&StageSeconds::read);
  ThreadPool pool(options.threads);
  TiledFit fit = TilePipeline(source, options, tiles, pool, clock).Fit();
  WarnOfParts(fit.whole.sample, pool, fit.whole.report);
  return fit;
}

std::vector<NurbsSurface> TileFaces(const TiledFit& fit) {
  const std::vector<TileSummary>& tiles = fit.whole.report.tiles;
  const NurbsSurface& whole = fit.whole.surface;
  std::vector<NurbsSurface> faces;
  std::size_t at = 0;
  for (const NurbsSurface& strip : Cut(whole, Direction::kU, fit.breaks_u)) {
    for (NurbsSurface& face : Cut(strip, Direction::kV, fit.breaks_v)) {
      if (whole.trimmed() || tiles[at++].points > 0) faces.push_back(std::move(face));
    }
  }
  return faces;
}

}  // namespace batten
