// SPDX-License-Identifier: MIT
#include "batten/fitting/curve_spans.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "fitting/core/rounding.h"
#include "fitting/core/shared_constants.h"
#include "fitting/foot_points/curve_distances.h"
#include "geometry/numeric/polygon.h"

namespace batten {
using namespace internal;
namespace {

// A control point counts as this many: plain cross-validation takes a few too many by chance.
// [Kim & Gu 2004]
constexpr double kFreedomFactor = 1.4;
constexpr double kDataPerControlPoint = 2;  // fewer, and the score has nothing to judge by
constexpr double kLadderStep = 1.22;
constexpr double kNoisyPerControlPoint = 2.1;  // data for each, where they are not exact
constexpr double kExactAgainstSpans = 0.25;    // noise in tolerances below which they are

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
    exact_ = points_ * std::pow(kRelativelyEqual * extent, 2);  // nothing left to gain
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

// Increasing.
std::vector<double> DifferentParameters(const FittingProblem& problem) {
  const Eigen::Matrix2Xd& given = problem.data().parameters;
  std::vector<double> parameters(given.row(0).begin(), given.row(0).end());
  std::sort(parameters.begin(), parameters.end());
  parameters.erase(std::unique(parameters.begin(), parameters.end()), parameters.end());
  return parameters;
}

// How many control points the data carry.
int MostControlPoints(Eigen::Index parameters, const SpanRefineOptions& options) {
  const bool exact = options.noise <= kExactAgainstSpans * options.tolerance;
  const auto carried = static_cast<double>(parameters);
  return std::min(options.max_control_points,
                  static_cast<int>(exact ? carried : carried / kNoisyPerControlPoint));
}

// Where a span can be cut so that both parts hold data, of increasing parameters: in its middle,
// else between the middle two of its data.
std::optional<double> CutOf(double low, double high, const std::vector<double>& parameters) {
  const auto from = [&](double u) {
    return std::lower_bound(parameters.begin(), parameters.end(), u);
  };
  const Eigen::Index count = from(high) - from(low);
  if (count < 2) return std::nullopt;
  double knot = low + (high - low) / 2;
  const Eigen::Index left = from(knot) - from(low);
  if (left == 0 || left == count) {
    const double a = from(low)[count / 2 - 1], b = from(low)[count / 2];
    knot = a + (b - a) / 2;
  }
  if (!(low < knot && knot < high)) return std::nullopt;
  return knot;
}

// The squared errors of the spans with data out of tolerance.
std::map<int, double> SpanErrors(const FittingProblem& problem,
                                 const Eigen::VectorXd& distances,
                                 double tolerance) {
  std::map<int, double> errors;
  for (Eigen::Index k = 0; k < distances.size(); ++k) {
    if (!(distances[k] > tolerance)) continue;
    errors[problem.basis_u().Span(problem.data().parameters(0, k))] += distances[k] * distances[k];
  }
  return errors;
}

// The problem with spans that hold data out of tolerance halved, at most `room` of them; none where
// there is none to halve.
std::optional<FittingProblem> Halved(const FittingProblem& problem,
                                     const Eigen::VectorXd& distances,
                                     double tolerance,
                                     const std::vector<double>& parameters,
                                     int room) {
  std::vector<double> knots = problem.basis_u().knots();
  std::vector<std::pair<double, double>> cuts;  // (−error, knot): worst first
  for (const auto& [span, error] : SpanErrors(problem, distances, tolerance)) {
    if (const auto knot = CutOf(knots[span], knots[span + 1], parameters))
      cuts.emplace_back(-error, *knot);
  }
  std::sort(cuts.begin(), cuts.end());
  if (cuts.empty() || room <= 0) return std::nullopt;
  cuts.resize(std::min(cuts.size(), static_cast<size_t>(room)));
  for (const auto& [error, knot] : cuts) knots.push_back(knot);
  std::sort(knots.begin(), knots.end());
  return problem.WithBasis(SplineBasis(problem.basis_u().degree(), std::move(knots)));
}

// Of data that count; zero of the others.
Eigen::VectorXd CountedDistances(const FittingProblem& problem,
                                 const Eigen::MatrixXd& coefficients,
                                 CurveDistance distance,
                                 ThreadPool& pool) {
  Eigen::VectorXd distances = CurveDistances(problem, coefficients, distance, pool);
  const Eigen::VectorXd& weights = problem.data().weights;
  if (weights.size() > 0) distances = (weights.array() > 0).select(distances, 0);
  return distances;
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
  const Eigen::Matrix3Xd points = PointsInSpace(values);
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
  const std::vector<double> parameters = DifferentParameters(problem);
  const int most = MostControlPoints(std::ssize(parameters), options);
  FittingProblem current = problem;
  std::optional<SpanRefinement> best;
  std::pair<Eigen::Index, double> best_score;
  std::vector<RoundSummary> rounds;
  Termination end = Termination::kMaxControlPoints;
  for (int round = 0; round < kMostIterations; ++round) {
    const auto start = Clock::now();
    LinearSolution solution = SolveLinear(current, pool);
    const Eigen::VectorXd distances =
        CountedDistances(current, solution.coefficients, options.distance, pool);
    const ErrorSummary error = Summarise(distances, options.tolerance);
    rounds.push_back(Round("refine", current.unknowns(), start));
    rounds.back().rms = error.rms;
    rounds.back().max = error.max;
    rounds.back().score = static_cast<double>(error.out_of_tolerance);
    const std::pair score(error.out_of_tolerance, error.rms);
    if (!best || score < best_score) {
      best_score = score;
      best = {current, std::move(solution), end, {}};
    }
    if (error.out_of_tolerance == 0) {
      end = Termination::kToleranceReached;
      break;
    }
    if (progress && !progress("refine", 0.05 * std::min(round, 19))) {
      end = Termination::kCancelled;
      break;
    }
    auto halved =
        Halved(current, distances, options.tolerance, parameters, most - current.unknowns());
    if (!halved) break;
    current = std::move(*halved);
  }
  best->termination = end;
  best->rounds = std::move(rounds);
  return std::move(*best);
}

}  // namespace batten
