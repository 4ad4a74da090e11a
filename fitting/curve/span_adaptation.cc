// SPDX-License-Identifier: MIT
#include "fitting/curve/span_adaptation.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

#include "fitting/core/point_rank.h"
#include "fitting/core/stopwatch.h"
#include "fitting/curve/knot_costs.h"
#include "fitting/curve/knot_relocation.h"
#include "fitting/curve/parameter_correction.h"
#include "fitting/least_squares/fitting_bases.h"
#include "fitting/ordering/curve_nodes.h"

namespace batten::internal {
namespace {

constexpr int kMostFootPointSteps = 12;
constexpr Eigen::Index kManyAdaptedPoints = 100000;  // for steps beyond the first ones
constexpr int kMostAdaptationRounds = 40;
constexpr int kMoreToBeFair = 5;        // one more for so many spans
constexpr double kGainInVariances = 4;  // variances of the noise: a larger difference halves a span
constexpr double kCostInVariances = 3;  // variances of the noise: cheaper knots are removed
constexpr double kCostRelocated = 2;    // in variances, of each knot [Akaike 1974]
constexpr int kPointsInHalf = 6;        // where residuals are noise,
constexpr int kPointsWhereFar = 2;      // and where they are far above it
constexpr double kFarInNoise = 2;
constexpr double kExactAgainst = 0.05;  // noise in tolerances: below it data are exact
constexpr double kMargin = 0.85;        // of the tolerance: fewer knots shall not bend more
constexpr int kFewInSpan = 20;
constexpr double kLeastShare = 0.25;  // of the degrees of freedom left for the noise

// Around a closed curve no fewer than its functions can tell apart.
int FewestSpans(const SpanLayout& layout) { return layout.closed() ? layout.degree() + 1 : 1; }

// Few steps without a tolerance, so as not to follow noise; with one, until parameters settle.
int FootPointSteps(const FittingProblem& problem, const SpanAdaptOptions& options) {
  if (!options.feet || !options.tolerance) return options.feet ? kFootPointSteps : 0;
  const Eigen::Index affordable = kManyAdaptedPoints / std::max<Eigen::Index>(1, problem.size());
  return static_cast<int>(
      std::clamp<Eigen::Index>(affordable, kFootPointSteps, kMostFootPointSteps));
}

double SquaresAcross(const FittingProblem& problem,
                     const Eigen::MatrixXd& coefficients,
                     bool feet,
                     ThreadPool& pool) {
  const Eigen::ArrayXd squares = DistancesAt(problem, coefficients, feet, pool).array().square();
  const Eigen::VectorXd& weights = problem.data().weights;
  return weights.size() > 0 ? (weights.array() * squares).sum() : squares.sum();
}

// A fit over one layout, with its distances from the data.
struct MeasuredFit {
  SpanLayout layout;
  FittingProblem problem;
  LinearSolution solution = {};
  bool at_foot_points = false;
  CurveSamples samples = {};  // tangents to measure across; zero unless at foot points
  Eigen::VectorXd distances = {};

  void Measure(ThreadPool& pool) {
    samples = CurveAt(problem, solution.coefficients, pool);
    if (!at_foot_points) samples.tangents.setZero();
    distances = Across(problem.data().values - samples.points, samples.tangents)
                    .colwise()
                    .norm()
                    .transpose();
    for (Eigen::Index k = 0; k < distances.size(); ++k) {
      if (WeightOf(problem.data(), k) == 0) distances[k] = 0;
    }
  }
};

// Half the mean squared difference of neighbouring residuals, all directions together.
double Variance(const FittingProblem& problem,
                const Eigen::MatrixXd& residuals,
                int control_points,
                double expected) {
  std::vector<Eigen::Index> order(static_cast<size_t>(residuals.cols()));
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  const auto u = problem.data().parameters.row(0);
  if (!std::is_sorted(u.begin(), u.end())) {
    std::stable_sort(
        order.begin(), order.end(), [&](Eigen::Index a, Eigen::Index b) { return u[a] < u[b]; });
  }
  double sum = 0, weights = 0;
  for (size_t k = 1; k < order.size(); ++k) {
    const double weight =
        std::min(WeightOf(problem.data(), order[k - 1]), WeightOf(problem.data(), order[k]));
    sum += weight * (residuals.col(order[k]) - residuals.col(order[k - 1])).squaredNorm();
    weights += weight;
  }
  const double used = static_cast<double>(control_points) / static_cast<double>(order.size());
  // So few points do not determine the noise.
  if (expected == 0 && order.size() < kFewestForNoise) return 0;
  return weights > 0 ? 0.5 * sum / weights / std::max(kLeastShare, 1 - used) : 0;
}

// The knots that may go, cheapest first: (cost, break).
std::vector<std::pair<double, int>> Costs(const MeasuredFit& fit, ThreadPool& pool) {
  std::vector<int> inner;
  std::vector<double> knots;
  for (int k = 1; k < fit.layout.spans(); ++k) {
    if (fit.layout.IsCorner(k)) continue;
    inner.push_back(k);
    knots.push_back(fit.layout.breaks()[static_cast<size_t>(k)]);
  }
  const std::vector<double> costs =
      RemovalCosts(fit.problem, fit.solution.coefficients, knots, pool);
  std::vector<std::pair<double, int>> sorted;
  for (size_t k = 0; k < knots.size(); ++k) sorted.emplace_back(costs[k], inner[k]);
  std::sort(sorted.begin(), sorted.end());
  return sorted;
}

// The layout without `most` of these knots at most, first ones first, none near another.
SpanLayout Thinned(const SpanLayout& layout,
                   const std::vector<std::pair<double, int>>& cheap,
                   size_t most) {
  std::vector<int> gone;
  for (const auto& [cost, k] : cheap) {
    if (gone.size() == most ||
        layout.spans() - static_cast<int>(gone.size()) <= FewestSpans(layout))
      break;
    const bool apart = std::all_of(gone.begin(), gone.end(), [&, at = k](int other) {
      return std::abs(at - other) > layout.degree();
    });
    if (apart) gone.push_back(k);
  }
  std::sort(gone.rbegin(), gone.rend());
  SpanLayout thinner = layout;
  for (const int k : gone) thinner = thinner.Without(k);
  return thinner;
}

class Adapter {
 public:
  Adapter(const FittingProblem& problem,
          const SpanLayout& start,
          const SpanAdaptOptions& options,
          ThreadPool& pool)
      : options_(options),
        pool_(pool),
        first_(problem),
        fit_{start, problem},
        rank_(PointRank(problem.data().values)),
        exact_(options.tolerance && options.noise < kExactAgainst * *options.tolerance) {}

  SpanAdaptation Run() {
    Fit(fit_.layout);
    for (int round = 0; round < kMostAdaptationRounds; ++round) {
      Report(options_.progress, "solve", 0.9 * round / kMostAdaptationRounds);
      const SpanLayout halved = Halved();
      if (halved.spans() == fit_.layout.spans()) break;
      Fit(halved);
    }
    if (options_.tolerance) {
      PruneWithinTolerance();
    } else {
      Prune();
    }
    const double noise = std::sqrt(variance_ / Directions());
    return {fit_.layout, fit_.problem, fit_.solution, noise, full_, rounds_};
  }

 private:
  double Directions() const { return std::max(1, rank_ - (fit_.at_foot_points ? 1 : 0)); }

  CorrectedFit Corrected(const SpanLayout& layout) const {
    return FitWithCorrection(first_.WithBasis(layout.Basis()),
                             FootPointSteps(first_, options_),
                             pool_,
                             options_.anchored);
  }

  void Fit(const SpanLayout& layout) {
    Stopwatch watch;
    CorrectedFit fit = Corrected(layout);
    fit_ = {layout, std::move(fit.problem), std::move(fit.solution), fit.steps > 0};
    fit_.Measure(pool_);
    RoundSummary round;
    round.stage = options_.tolerance ? "refine" : "adapt";
    round.control_points_u = fit_.layout.control_points();
    round.control_points_v = 1;
    round.rms = std::sqrt(fit_.distances.squaredNorm() / static_cast<double>(fit_.problem.size()));
    round.max = fit_.distances.maxCoeff();
    round.score = std::sqrt(variance_ / Directions());
    round.seconds = watch.Lap();
    rounds_.push_back(round);
  }

  // The layout with the spans halved that ask for it.
  SpanLayout Halved() {
    const std::vector<bool> can = Divisible();
    if (std::find(can.begin(), can.end(), true) == can.end()) return fit_.layout;
    const SpanLayout finer = fit_.layout.Halved(can);
    const CorrectedFit fine = Corrected(finer);
    const Eigen::MatrixXd points = EvaluateAt(fine.problem, fine.solution.coefficients, pool_);
    variance_ = Variance(fit_.problem,
                         Across(fit_.problem.data().values - points, fit_.samples.tangents),
                         finer.control_points(),
                         options_.noise);
    const Eigen::MatrixXd change = Across(points - fit_.samples.points, fit_.samples.tangents);
    std::vector<double> gains(can.size(), 0.0), held(gains);
    std::vector<bool> missed(can.size(), !options_.tolerance);
    for (Eigen::Index k = 0; k < change.cols(); ++k) {
      const auto span =
          static_cast<size_t>(fit_.layout.SpanOf(fit_.problem.data().parameters(0, k)));
      const double weight = WeightOf(fit_.problem.data(), k);
      held[span] += weight;
      gains[span] += weight * change.col(k).squaredNorm();
      if (options_.tolerance && fit_.distances[k] > *options_.tolerance) missed[span] = true;
    }
    const double least = kGainInVariances * variance_, alike = options_.exact * options_.exact;
    std::vector<std::pair<double, size_t>> chosen;
    for (size_t span = 0; span < can.size(); ++span) {
      if (can[span] && missed[span] && gains[span] > std::max(least, held[span] * alike))
        chosen.emplace_back(-gains[span], span);
    }
    const auto room = static_cast<size_t>(std::max(0, Limit() - fit_.layout.control_points()));
    if (chosen.size() > room) {
      full_ = Limit() == options_.max_control_points;
      std::sort(chosen.begin(), chosen.end());
      chosen.resize(room);
    }
    std::vector<bool> where(can.size(), false);
    for (const auto& [gain, span] : chosen) where[span] = true;
    return chosen.empty() ? fit_.layout : fit_.layout.Halved(where);
  }

  // The most control points: as many as there are data.
  int Limit() const {
    const Eigen::VectorXd& weights = fit_.problem.data().weights;
    const Eigen::Index data =
        weights.size() > 0 ? (weights.array() > 0).count() : fit_.problem.size();
    return static_cast<int>(std::min<Eigen::Index>(options_.max_control_points, data));
  }

  // The spans both halves of which hold data enough.
  std::vector<bool> Divisible() const {
    const std::vector<double>& breaks = fit_.layout.breaks();
    std::vector<int> left(breaks.size() - 1, 0), right(left);
    std::vector<double> squares(left.size(), 0.0), worst(squares);
    for (Eigen::Index k = 0; k < fit_.problem.size(); ++k) {
      if (WeightOf(fit_.problem.data(), k) == 0) continue;
      const double u = fit_.problem.data().parameters(0, k);
      const auto span = static_cast<size_t>(fit_.layout.SpanOf(u));
      squares[span] += fit_.distances[k] * fit_.distances[k];
      worst[span] = std::max(worst[span], fit_.distances[k]);
      ++(u < breaks[span] + (breaks[span + 1] - breaks[span]) / 2 ? left : right)[span];
    }
    // With few points apparent noise may be distance from the coarse curve: use the finer curve.
    const double exact = Directions() * options_.exact * options_.exact;
    double noise = Directions() * options_.noise * options_.noise;
    if (variance_ > 0) noise = std::min(noise, variance_);
    std::vector<bool> can(left.size());
    for (size_t span = 0; span < can.size(); ++span) {
      const double expected = (left[span] + right[span]) * std::max(noise, exact);
      const bool far = squares[span] > kFarInNoise * kFarInNoise * expected;
      const bool missed =
          options_.tolerance && squares[span] > 0 && worst[span] > *options_.tolerance;
      const bool few_are_enough = exact_ || options_.noise == 0;
      const int needed = far && few_are_enough ? 1
                         : far || missed       ? kPointsWhereFar
                                               : kPointsInHalf;
      can[span] = std::min(left[span], right[span]) >= needed;
    }
    return can;
  }

  // Removes the knots that cost less than noise would.
  void Prune() {
    for (int round = 0; round < kMostAdaptationRounds; ++round) {
      Report(options_.progress, "solve", 0.9 + 0.1 * round / kMostAdaptationRounds);
      std::vector<std::pair<double, int>> cheap = Costs(fit_, pool_);
      const double held = static_cast<double>(fit_.problem.size()) / fit_.layout.spans();
      const double least =
          std::max(kCostInVariances * variance_, held * options_.exact * options_.exact);
      cheap.erase(std::partition_point(
                      cheap.begin(), cheap.end(), [&](const auto& c) { return c.first < least; }),
                  cheap.end());
      const SpanLayout thinner = Thinned(fit_.layout, cheap, cheap.size());
      if (thinner.spans() == fit_.layout.spans()) return;
      Fit(thinner);
    }
  }

  // Removes knots, cheapest first, as long as the tolerance is kept; where a batch is too many,
  // half of it.
  void PruneWithinTolerance() {
    if (fit_.distances.maxCoeff() > *options_.tolerance) return;
    const double limit = std::max(kMargin * *options_.tolerance, fit_.distances.maxCoeff());
    size_t most = fit_.layout.breaks().size();
    for (int round = 0; round < kMostAdaptationRounds && most > 0; ++round) {
      Report(options_.progress, "refine", 0.9 + 0.1 * round / kMostAdaptationRounds);
      const SpanLayout thinner = Thinned(fit_.layout, Costs(fit_, pool_), most);
      const auto fewer = static_cast<size_t>(fit_.layout.spans() - thinner.spans());
      if (fewer == 0) return;
      MeasuredFit before = fit_;
      Fit(thinner);
      if (fit_.distances.maxCoeff() <= limit) continue;
      fit_ = std::move(before);
      most = fewer / 2;
    }
  }

  const SpanAdaptOptions& options_;
  ThreadPool& pool_;
  FittingProblem first_;  // at the parameters given
  MeasuredFit fit_;
  int rank_;    // of the data: noise is in so many directions
  bool exact_;  // against the tolerance
  double variance_ = 0;
  bool full_ = false;
  std::vector<RoundSummary> rounds_;
};

}  // namespace

SpanAdaptation AdaptSpans(const FittingProblem& problem,
                          const SpanLayout& start,
                          const SpanAdaptOptions& options,
                          ThreadPool& pool) {
  return Adapter(problem, start, options, pool).Run();
}

namespace {

// The same data over other layouts, with knots relocated.
class Relocation {
 public:
  Relocation(const SpanAdaptation& adapted, const SpanAdaptOptions& options, ThreadPool& pool)
      : start_(adapted.layout),
        problem_(adapted.problem),
        options_(options),
        pool_(pool),
        trials_(adapted.problem, adapted.layout.spans()) {}

  // Relocated layouts of so many spans each: from even ones and from the adapted ones. Where
  // distances count more than squares, those themselves too.
  std::vector<SpanLayout> Layouts(const std::vector<int>& counts) const {
    std::vector<SpanLayout> layouts;
    std::vector<size_t> relocated;
    const std::vector<double>& breaks = start_.breaks();
    for (const int spans : counts) {
      if (spans < FewestSpans(start_)) continue;
      for (const SpanLayout& from : {SpanLayout::Equal(start_.degree(),
                                                       spans,
                                                       breaks.front(),
                                                       breaks.back(),
                                                       start_.corners(),
                                                       start_.closed()),
                                     start_.Resampled(spans)}) {
        if (options_.tolerance) layouts.push_back(from);
        relocated.push_back(layouts.size());
        layouts.push_back(from);
      }
    }
    Report(options_.progress, "solve", 0.95);
    pool_.For(std::ssize(relocated), 1, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
      for (std::ptrdiff_t k = begin; k < end; ++k) {
        SpanLayout& layout = layouts[relocated[static_cast<size_t>(k)]];
        layout = RelocateKnots(trials_, layout);
      }
    });
    return layouts;
  }

  // Fits the layout; with a tolerance, at minimum distances.
  CorrectedFit Fit(const SpanLayout& layout) const {
    CorrectedFit fit = FitWithCorrection(problem_.WithBasis(layout.Basis()),
                                         FootPointSteps(problem_, options_),
                                         pool_,
                                         options_.anchored);
    const bool lower = options_.tolerance && options_.feet && options_.anchored.empty();
    return lower ? AtMinimumDistance(fit, {.max_rounds = kRoundsOfDistance}, pool_) : fit;
  }

 private:
  const SpanLayout start_;
  const FittingProblem problem_;
  const SpanAdaptOptions& options_;
  ThreadPool& pool_;
  LayoutTrials trials_;
};

RoundSummary Relocated(const SpanLayout& layout, const CorrectedFit& fit, double score) {
  RoundSummary round;
  round.stage = "relocate";
  round.control_points_u = layout.control_points();
  round.control_points_v = 1;
  round.rms = std::sqrt(fit.solution.residual_squares / static_cast<double>(fit.problem.size()));
  round.score = score;
  return round;
}

void Adopt(const SpanLayout& layout, CorrectedFit&& fit, SpanAdaptation& adapted) {
  adapted.layout = layout;
  adapted.problem = std::move(fit.problem);
  adapted.solution = std::move(fit.solution);
}

}  // namespace

SpanAdaptation RelocatedSpans(SpanAdaptation adapted,
                              const SpanAdaptOptions& options,
                              ThreadPool& pool) {
  const double directions =
      std::max(1, PointRank(adapted.problem.data().values) - (options.feet ? 1 : 0));
  const double per_knot = kCostRelocated * directions *
                          std::max(adapted.noise * adapted.noise, options.exact * options.exact);
  const auto score = [&](const FittingProblem& problem, const LinearSolution& solution) {
    return SquaresAcross(problem, solution.coefficients, options.feet, pool) +
           per_knot * problem.unknowns();
  };
  const Relocation relocation(adapted, options, pool);
  const int spans = adapted.layout.spans();
  double best = score(adapted.problem, adapted.solution);
  // Where data are few, halving stops early: as many knots in better places help too, and some
  // more.
  std::vector<double> shares{0.7, 0.8, 0.9};
  if (adapted.problem.size() < kFewInSpan * spans) shares.insert(shares.end(), {1.0, 1.15, 1.3});
  std::vector<int> counts;
  for (const double share : shares) counts.push_back(static_cast<int>(std::lround(share * spans)));
  for (const SpanLayout& layout : relocation.Layouts(counts)) {
    CorrectedFit fit = relocation.Fit(layout);
    const double found = score(fit.problem, fit.solution);
    adapted.rounds.push_back(Relocated(layout, fit, found));
    if (!(found < best)) continue;
    best = found;
    Adopt(layout, std::move(fit), adapted);
  }
  return adapted;
}

SpanAdaptation RelocatedWithinTolerance(SpanAdaptation adapted,
                                        const SpanAdaptOptions& options,
                                        ThreadPool& pool) {
  const double asked = options.tolerance.value();
  const auto worst = [&](const FittingProblem& problem, const LinearSolution& solution) {
    return DistancesAt(problem, solution.coefficients, options.feet, pool).maxCoeff();
  };
  const Relocation relocation(adapted, options, pool);
  const int spans = adapted.layout.spans();
  const bool kept = worst(adapted.problem, adapted.solution) <= asked;
  const double tolerance = kept ? kMargin * asked : asked;
  const int most = kept ? spans - 1 : spans + std::max(2, spans / 4);
  int tried = 0, last = most;
  std::optional<int> fewest;  // inflections
  for (double share = kept ? 0.6 : 1.0; tried < last; share *= 1.06) {
    tried = std::max(tried + 1, static_cast<int>(std::lround(share * spans)));
    if (tried > last) break;
    for (const SpanLayout& layout : relocation.Layouts({tried})) {
      if (layout.control_points() > options.max_control_points) continue;
      CorrectedFit fit = relocation.Fit(layout);
      const double found = worst(fit.problem, fit.solution);
      adapted.rounds.push_back(Relocated(layout, fit, found));
      if (!(found <= tolerance)) continue;
      // A few knots more may bend the curve to and fro less.
      if (!fewest) last = std::min(last, tried + std::max(2, tried / kMoreToBeFair));
      const int inflections = Inflections(layout.Basis(), fit.solution.coefficients);
      if (fewest && inflections >= *fewest) continue;
      fewest = inflections;
      Adopt(layout, std::move(fit), adapted);
    }
  }
  return adapted;
}

}  // namespace batten::internal
