// SPDX-License-Identifier: MIT
#include "fitting/surface/refine.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <tuple>
#include <utility>

#include "batten/fitting/distances.h"
#include "batten/fitting/solve_linear.h"
#include "fitting/knots/knot_grid_selection.h"
#include "fitting/knots/knot_line_removal.h"
#include "fitting/least_squares/fitting_bases.h"
#include "fitting/surface/bounded_solution.h"

namespace batten::internal {
namespace {

constexpr double kPointsPerControlPoint = 2.1;
constexpr double kGrowth = 1.25;      // factor on control points in a round, at most
constexpr double kWorthOfBest = 0.3;  // lines scoring less than this share wait for a later round
constexpr double kNarrowestInSpacings = 0.65;  // spacings: no knot makes a narrower cell
constexpr int kReweightingRounds = 15;

struct Line {
  bool in_u;
  double knot;
  double score;
};

// Sums the error above half the tolerance span by span, capped so that no single point decides.
std::vector<double> SpanScores(const SplineBasis& basis,
                               const Eigen::VectorXd& parameters,
                               const Eigen::VectorXd& distances,
                               double tolerance) {
  std::vector<double> scores(static_cast<size_t>(basis.size()), 0.0);
  for (Eigen::Index k = 0; k < distances.size(); ++k) {
    const double r = std::abs(distances[k]);
    if (r > tolerance / 2)
      scores[basis.Span(parameters[k])] += std::min(r * r, 9 * tolerance * tolerance);
  }
  return scores;
}

// The factor on a point's weight in the next round: larger near the tolerance, where the point can
// be brought in; smaller far beyond it.
double Emphasis(double distance, double tolerance) {
  const double a = std::abs(distance) / tolerance;
  if (a < 1.6) return std::pow(std::clamp(a, 0.3, 2.0), 2);
  return std::max(0.05, 2.56 * std::exp(-2 * (a - 1.6)));
}

class Refinement {
 public:
  Refinement(const FitContext& context,
             const Eigen::Matrix3Xd& points,
             const FittingProblem& problem)
      : context_(context),
        points_(points),
        problem_(problem),
        tolerance_(*context.options().tolerance) {
    const SurfaceFitOptions& options = context.options();
    limit_ =
        std::min<double>(options.control_points ? problem.unknowns() : options.max_control_points,
                         static_cast<double>(points.cols()) / kPointsPerControlPoint);
  }

  // Solves, measures distances, keeps the best state. Returns the number of points out of
  // tolerance.
  Eigen::Index Round(const char* stage) {
    const auto start = std::chrono::steady_clock::now();
    const LinearSolution solution = Solve();
    const auto points = static_cast<double>(points_.cols());
    const double freedom = std::max(1.0, points - kFreedomFactor * problem_.unknowns());
    validation_ = points * solution.residual_squares / (freedom * freedom);
    return Measure(stage, solution, start);
  }

  // Generalised cross-validation of the last round: rises once refinement follows noise.
  double validation() const { return validation_; }

  // Saves the present state, and restores it.
  void Remember() { remembered_ = {best_, best_parameters_, best_problem_}; }
  void Return() { std::tie(best_, best_parameters_, best_problem_) = remembered_; }

 private:
  LinearSolution Solve() const {
    // Holding it in the box may cost any error where it is not to be trimmed to its points.
    const bool untrimmed = context_.options().trim == Trimming::kNone;
    return SolveWithinBounds(problem_,
                             context_.spacing(),
                             context_.pool(),
                             untrimmed ? HUGE_VAL : kAtNoise * context_.noise(),
                             context_.noise(),
                             1)  // round: it is one of many solves
        .solution;
  }

  // The surface of a solution, and the foot points of the data on it.
  NurbsSurface SurfaceOf(const FittingProblem& problem, const LinearSolution& solution) const {
    return context_.base().Surface(problem.basis_u(), problem.basis_v(), solution.coefficients);
  }
  PointDistances Distances(const FittingProblem& problem, const NurbsSurface& surface) const {
    return DistancesFrom(surface, points_, problem.data().parameters, context_.pool());
  }

  // Removes knot lines that the tolerance does not need.
  void RemoveLines() {
    const auto start = std::chrono::steady_clock::now();
    const int before = best_problem_->unknowns();
    const auto kept = [&](const FittingProblem& problem, const LinearSolution& solution) {
      return Distances(problem, SurfaceOf(problem, solution)).distances.cwiseAbs().maxCoeff() <=
             tolerance_;
    };
    const FittingProblem fewer = RemoveKnotLines(*best_problem_, kept, context_.pool());
    if (fewer.unknowns() == before) return;
    Remember();
    problem_ = fewer;
    best_.reset();
    if (Measure("fewer lines", Solve(), start) > 0) Return();  // held at the bounds
  }

  Eigen::Index Measure(const char* stage,
                       const LinearSolution& solution,
                       std::chrono::steady_clock::time_point start) {
    NurbsSurface surface = SurfaceOf(problem_, solution);
    PointDistances found = Distances(problem_, surface);
    distances_ = found.distances;
    const ErrorSummary error = Summarise(distances_, tolerance_);
    RoundSummary round;
    round.stage = stage;
    round.control_points_u = problem_.basis_u().size();
    round.control_points_v = problem_.basis_v().size();
    round.rms = error.rms;
    round.max = error.max;
    round.score = static_cast<double>(error.out_of_tolerance);
    round.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    rounds_.push_back(round);
    if (!best_ || std::pair(error.out_of_tolerance, error.rms) < best_score_) {
      best_score_ = {error.out_of_tolerance, error.rms};
      best_ = std::move(surface);
      best_problem_ = problem_;
      best_parameters_ = std::move(found.parameters);
    }
    return error.out_of_tolerance;
  }

 public:
  // Inserts the knot lines that pay most. Returns whether there was one.
  bool InsertLines() {
    std::vector<Line> lines;
    Collect(true, lines);
    Collect(false, lines);
    std::sort(lines.begin(), lines.end(), [](const Line& a, const Line& b) {
      return a.score != b.score ? a.score > b.score
                                : std::pair(a.in_u, a.knot) < std::pair(b.in_u, b.knot);
    });
    std::vector<double> in_u, in_v;
    const double size_u = problem_.basis_u().size(), size_v = problem_.basis_v().size();
    const double round_limit = std::min(
        limit_, std::max(kGrowth * size_u * size_v, size_u * size_v + std::max(size_u, size_v)));
    for (const Line& line : lines) {
      if (line.score < kWorthOfBest * lines.front().score) break;
      const double nu = size_u + static_cast<double>(in_u.size()) + (line.in_u ? 1 : 0);
      const double nv = size_v + static_cast<double>(in_v.size()) + (line.in_u ? 0 : 1);
      if (nu * nv > round_limit) continue;
      (line.in_u ? in_u : in_v).push_back(line.knot);
    }
    narrowest_ = lines.empty();
    if (in_u.empty() && in_v.empty()) return false;
    problem_ = problem_.WithBases(WithInnerKnots(problem_.basis_u(), in_u),
                                  WithInnerKnots(problem_.basis_v(), in_v));
    return true;
  }

  // Reweights points by their distance against the tolerance.
  void Reweight() {
    const Eigen::VectorXd& given = problem_.data().weights;
    if (original_.size() == 0) {
      original_ = given.size() > 0 ? given : Eigen::VectorXd::Ones(problem_.size()).eval();
      emphasis_ = Eigen::VectorXd::Ones(problem_.size());
    }
    for (Eigen::Index k = 0; k < points_.cols(); ++k) {
      emphasis_[k] = std::sqrt(emphasis_[k] * Emphasis(distances_[k], tolerance_));
    }
    problem_ = problem_.WithWeights(original_.cwiseProduct(emphasis_));
  }

  // The expected number of points out of tolerance on a perfect surface, for normal noise of the
  // estimated size.
  double NoiseOut() const {
    if (!(context_.noise() > 0)) return 0;
    const double beyond = std::erfc(tolerance_ / (context_.noise() * std::sqrt(2.0)));
    return static_cast<double>(points_.cols()) * beyond;
  }

  // Whether spans with points out of tolerance were all as narrow as the spacing lets them be.
  bool narrowest() const { return narrowest_; }

  RefineResult Finish(EndCode end) {
    if (end == EndCode::kToleranceReached) RemoveLines();
    return {std::move(*best_), std::move(best_parameters_), end, std::move(rounds_)};
  }

 private:
  void Collect(bool in_u, std::vector<Line>& lines) const {
    const SplineBasis& basis = in_u ? problem_.basis_u() : problem_.basis_v();
    const int added = in_u ? problem_.basis_v().size() : problem_.basis_u().size();
    const std::vector<double> scores =
        SpanScores(basis, problem_.data().parameters.row(in_u ? 0 : 1), distances_, tolerance_);
    for (const int span : basis.Spans()) {
      const double a = basis.knots()[span], b = basis.knots()[span + 1];
      if (scores[span] > 0 && (b - a) / 2 >= kNarrowestInSpacings * context_.spacing()) {
        lines.push_back({in_u, (a + b) / 2, scores[span] / added});
      }
    }
  }

  const FitContext& context_;
  const Eigen::Matrix3Xd& points_;
  FittingProblem problem_;
  double tolerance_, limit_;
  Eigen::VectorXd distances_, original_, emphasis_;
  std::optional<NurbsSurface> best_;
  std::optional<FittingProblem> best_problem_;
  double validation_ = 0;
  bool narrowest_ = false;
  std::tuple<std::optional<NurbsSurface>, Eigen::Matrix2Xd, std::optional<FittingProblem>>
      remembered_;
  Eigen::Matrix2Xd best_parameters_;
  std::pair<Eigen::Index, double> best_score_{};
  std::vector<RoundSummary> rounds_;
};

}  // namespace

RefineResult RefineToTolerance(const FitContext& context,
                               const Eigen::Matrix3Xd& points,
                               const FittingProblem& problem) {
  Refinement refinement(context, points, problem);
  const Progress& progress = context.options().progress;
  const auto cancelled = [&](double fraction) { return progress && !progress("refine", fraction); };
  double validation = std::numeric_limits<double>::infinity();
  constexpr int kMaxRounds = 200;
  for (int round = 0; round < kMaxRounds; ++round) {
    const Eigen::Index out = refinement.Round("refine");
    if (out == 0) return refinement.Finish(EndCode::kToleranceReached);
    // No more points are out than noise alone explains: continue only while validation on left-out
    // points improves, because the noise of sparse exact points is easily overestimated.
    const double noise_out = refinement.NoiseOut();
    const bool as_noise = static_cast<double>(out) <= noise_out + 2 * std::sqrt(noise_out);
    if (as_noise && refinement.validation() >= validation) {
      refinement.Return();
      return refinement.Finish(EndCode::kNoiseReached);
    }
    if (as_noise) refinement.Remember();
    validation = as_noise ? refinement.validation() : std::numeric_limits<double>::infinity();
    if (cancelled(0.02 * std::min(round, 40))) return refinement.Finish(EndCode::kCancelled);
    if (!refinement.InsertLines()) break;
  }
  for (int round = 0; round < kReweightingRounds; ++round) {
    refinement.Reweight();
    if (refinement.Round("reweight") == 0) return refinement.Finish(EndCode::kToleranceReached);
    if (cancelled(0.8 + 0.2 * round / kReweightingRounds))
      return refinement.Finish(EndCode::kCancelled);
  }
  return refinement.Finish(refinement.narrowest() ? EndCode::kDetailBelowSpacing
                                                  : EndCode::kMaxControlPoints);
}

}  // namespace batten::internal
