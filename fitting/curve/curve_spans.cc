// SPDX-License-Identifier: MIT
#include "batten/fitting/curve_spans.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "fitting/foot_points/curve_distances.h"

namespace batten {
using namespace internal;
namespace {

// A control point counts as this many: plain cross-validation takes a few too many by chance.
// [Kim & Gu 2004]
constexpr double kFreedomFactor = 1.4;
constexpr double kDataPerControlPoint = 2;  // fewer, and the score has nothing to judge by
constexpr double kLadderStep = 1.22;
constexpr double kExactSpans = 1e-9;           // of the data's extent: nothing left to gain
constexpr double kNoisyPerControlPoint = 2.1;  // data for each, where they are not exact
constexpr double kExactAgainstSpans = 0.25;    // noise in tolerances below which they are
constexpr int kMostSpanRounds = 100;

using Clock = std::chrono::steady_clock;

RoundSummary Round(const char* stage, int control_points, Clock::time_point start) {
  RoundSummary round;
  round.stage = stage;
  round.control_points_u = control_points;
  round.control_points_v = 1;
  round.seconds = std::chrono::duration<double>(Clock::now() - start).count();
  return round;
}

FittingProblem WithSpans(const FittingProblem& problem, int spans) {
  const SplineBasis& basis = problem.basis_u();
  return problem.WithBasis(
      SplineBasis::Uniform(basis.degree(), basis.degree() + spans, basis.lower(), basis.upper()));
}

class Ladder {
 public:
  Ladder(const FittingProblem& problem, int max_control_points, ThreadPool& pool)
      : problem_(problem), pool_(pool), points_(static_cast<double>(problem.size())) {
    const Eigen::VectorXd middle = problem.data().values.rowwise().mean();
    const double extent = (problem.data().values.colwise() - middle).cwiseAbs().maxCoeff();
    exact_ = points_ * std::pow(kExactSpans * extent, 2);
    most_ =
        std::max(1,
                 std::min(max_control_points, static_cast<int>(points_ / kDataPerControlPoint)) -
                     problem.basis_u().degree());
  }

  int most() const { return most_; }

  double Score(int spans) {
    const auto [known, fresh] = scores_.try_emplace(spans, 0.0);
    if (!fresh) return known->second;
    const auto start = Clock::now();
    const FittingProblem rung = WithSpans(problem_, spans);
    const double squares = SolveLinear(rung, pool_).residual_squares;
    const double freedom = std::max(1.0, points_ - kFreedomFactor * rung.unknowns());
    known->second = points_ * std::max(squares, exact_) / (freedom * freedom);
    rounds.push_back(Round("cross-validation", rung.unknowns(), start));
    rounds.back().rms = std::sqrt(squares / points_);
    rounds.back().score = known->second;
    return known->second;
  }

  std::vector<RoundSummary> rounds;

 private:
  const FittingProblem& problem_;
  ThreadPool& pool_;
  double points_, exact_;
  int most_;
  std::map<int, double> scores_;
};

// How many different parameters lie in [low, high), the data being sorted.
Eigen::Index Different(const std::vector<double>& parameters, double low, double high) {
  return std::lower_bound(parameters.begin(), parameters.end(), high) -
         std::lower_bound(parameters.begin(), parameters.end(), low);
}

class Refinement {
 public:
  Refinement(const FittingProblem& problem, const SpanRefineOptions& options, ThreadPool& pool)
      : problem_(problem), options_(options), pool_(pool) {
    const Eigen::Matrix2Xd& given = problem.data().parameters;
    parameters_.assign(given.row(0).begin(), given.row(0).end());
    std::sort(parameters_.begin(), parameters_.end());
    parameters_.erase(std::unique(parameters_.begin(), parameters_.end()), parameters_.end());
    const bool exact = options.noise <= kExactAgainstSpans * options.tolerance;
    const double carried = static_cast<double>(parameters_.size());
    limit_ = std::min(options.max_control_points,
                      static_cast<int>(exact ? carried : carried / kNoisyPerControlPoint));
  }

  // Solves, measures, remembers the best. Returns how many data are out of tolerance.
  Eigen::Index Solve() {
    const auto start = Clock::now();
    LinearSolution solution = SolveLinear(problem_, pool_);
    distances_ = CurveDistances(problem_, solution.coefficients, options_.distance, pool_);
    const Eigen::VectorXd& weights = problem_.data().weights;
    if (weights.size() > 0) distances_ = (weights.array() > 0).select(distances_, 0);
    const ErrorSummary error = Summarise(distances_, options_.tolerance);
    rounds_.push_back(Round("refine", problem_.unknowns(), start));
    rounds_.back().rms = error.rms;
    rounds_.back().max = error.max;
    rounds_.back().score = static_cast<double>(error.out_of_tolerance);
    const std::pair score(error.out_of_tolerance, error.rms);
    if (!best_ || score < best_score_) {
      best_score_ = score;
      best_ = {problem_, std::move(solution)};
    }
    return error.out_of_tolerance;
  }

  // Halves spans that hold data out of tolerance. Returns whether there was one to halve.
  bool Halve() {
    std::vector<std::pair<double, double>> cuts;  // (−error, knot): worst first
    for (const auto& [span, error] : SpanErrors()) {
      if (const auto knot = Middle(span)) cuts.emplace_back(-error, *knot);
    }
    std::sort(cuts.begin(), cuts.end());
    const int room = limit_ - problem_.unknowns();
    if (cuts.empty() || room <= 0) return false;
    cuts.resize(std::min(cuts.size(), static_cast<size_t>(room)));
    std::vector<double> knots = problem_.basis_u().knots();
    for (const auto& [error, knot] : cuts) knots.push_back(knot);
    std::sort(knots.begin(), knots.end());
    problem_ = problem_.WithBasis(SplineBasis(problem_.basis_u().degree(), std::move(knots)));
    return true;
  }

  SpanRefinement Finish(Termination termination) && {
    return {std::move(best_->first), std::move(best_->second), termination, std::move(rounds_)};
  }

 private:
  // The squared errors of the spans with data out of tolerance.
  std::map<int, double> SpanErrors() const {
    std::map<int, double> errors;
    for (Eigen::Index k = 0; k < distances_.size(); ++k) {
      if (!(distances_[k] > options_.tolerance)) continue;
      errors[problem_.basis_u().Span(problem_.data().parameters(0, k))] +=
          distances_[k] * distances_[k];
    }
    return errors;
  }

  // Where a span can be cut so that both parts hold data: in its middle, else between the middle
  // two of its data.
  std::optional<double> Middle(int span) const {
    const double low = problem_.basis_u().knots()[span],
                 high = problem_.basis_u().knots()[span + 1];
    const Eigen::Index count = Different(parameters_, low, high);
    if (count < 2) return std::nullopt;
    double knot = low + (high - low) / 2;
    const Eigen::Index left = Different(parameters_, low, knot);
    if (left == 0 || left == count) {
      const auto first = std::lower_bound(parameters_.begin(), parameters_.end(), low);
      const double a = first[count / 2 - 1], b = first[count / 2];
      knot = a + (b - a) / 2;
    }
    if (!(low < knot && knot < high)) return std::nullopt;
    return knot;
  }

  FittingProblem problem_;
  const SpanRefineOptions& options_;
  ThreadPool& pool_;
  std::vector<double> parameters_;  // the different ones, increasing
  int limit_;
  Eigen::VectorXd distances_;
  std::optional<std::pair<FittingProblem, LinearSolution>> best_;
  std::pair<Eigen::Index, double> best_score_{};
  std::vector<RoundSummary> rounds_;
};

// Points in space; plane ones at z = 0.
Eigen::Matrix3Xd InSpace(const Eigen::MatrixXd& values) {
  Eigen::Matrix3Xd points = Eigen::Matrix3Xd::Zero(3, values.cols());
  points.topRows(values.rows()) = values;
  return points;
}

}  // namespace

Eigen::VectorXd CurveDistances(const FittingProblem& problem,
                               const Eigen::MatrixXd& coefficients,
                               CurveDistance distance,
                               ThreadPool& pool) {
  const Eigen::MatrixXd& values = problem.data().values;
  if (distance == CurveDistance::kParameter) {
    return (EvaluateAt(problem, coefficients, pool) - values).colwise().norm();
  }
  const Eigen::Matrix3Xd points = InSpace(values);
  const SplineBasis& basis = problem.basis_u();
  const Eigen::VectorXd places = problem.data().parameters.row(0).transpose();
  return values.rows() == 2
             ? DistancesNear<2>(CurveOf<2>(basis, coefficients), points, places, pool).distances
             : DistancesNear<3>(CurveOf<3>(basis, coefficients), points, places, pool).distances;
}

SpanChoice ChooseSpans(const FittingProblem& problem,
                       int max_control_points,
                       ThreadPool& pool,
                       const Progress& progress) {
  Ladder ladder(problem, max_control_points, pool);
  int best = 1;
  const auto take = [&](int spans) {
    if (spans < 1 || spans > ladder.most()) return false;
    if (!(ladder.Score(spans) < ladder.Score(best))) return false;
    best = spans;
    return true;
  };
  for (int spans = 1; spans <= ladder.most();
       spans = std::max(spans + 1, static_cast<int>(std::lround(spans * kLadderStep)))) {
    take(spans);
    Report(progress, "solve", 0.8 * spans / ladder.most());
  }
  for (const double share : {0.1, 0.05, 0.025, 0.0}) {
    const int step = std::max(1, static_cast<int>(share * best));
    while (take(best + step) || take(best - step)) Report(progress, "solve", 0.9);
  }
  return {WithSpans(problem, best), std::move(ladder.rounds)};
}

SpanRefinement RefineSpans(const FittingProblem& problem,
                           const SpanRefineOptions& options,
                           ThreadPool& pool,
                           const Progress& progress) {
  Refinement refinement(problem, options, pool);
  for (int round = 0; round < kMostSpanRounds; ++round) {
    if (refinement.Solve() == 0)
      return std::move(refinement).Finish(Termination::kToleranceReached);
    if (progress && !progress("refine", 0.05 * std::min(round, 19))) {
      return std::move(refinement).Finish(Termination::kCancelled);
    }
    if (!refinement.Halve()) break;
  }
  return std::move(refinement).Finish(Termination::kMaxControlPoints);
}

}  // namespace batten
