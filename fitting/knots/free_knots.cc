// SPDX-License-Identifier: MIT
#include "batten/fitting/free_knots.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <thread>

#include "fitting/core/stopwatch.h"
#include "fitting/core/unit_of.h"
#include "fitting/knots/knot_search.h"
#include "geometry/numeric/reject.h"

namespace batten {
using namespace internal;
namespace {

// The search effort follows from the work of one evaluation, in products of a datum with its basis
// functions (about 0.1 µs): 201 data of a cubic curve have 800, 4000 of a bicubic surface 64 000.
// Below the first number the search is full; above the second the last steps on all data are few;
// above the third, descents run one after another on all threads instead of side by side.
constexpr double kFullSearch = 4e3, kCheap = 2e4, kSideBySide = 1e5;

// Free knots from random places: above that many, starts are fewer, since descents get longer.
constexpr double kFullyStarted = 16;

// Work of factoring the matrix of k free knots and of its eigenvalues, in units of k³.
constexpr double kKnotsCubed = 0.05;

// Budget of insertion, of exchanging knots and of closing gaps, each: iterations times the work of
// one.
constexpr double kWork = 1e7;

// Iterations of one descent to the precision that insertion needs.
constexpr double kIterationsOfOne = 15;

// Gaps below this share of the domain are closed if that costs nothing.
constexpr double kNarrow = 1e-3;

// Share of Φ that a step must gain to go on, in rough descents and where a step is expensive.
constexpr double kRough = 1e-6;

// Number of the best descents that are polished.
constexpr int kPolished = 4;

// Asks the caller and the clock whether to go on; the caller only from the caller's thread.
class Watch {
 public:
  explicit Watch(const FreeKnotOptions& options)
      : options_(options), caller_(std::this_thread::get_id()) {}

  bool Stop() {
    if (stopped_) return true;
    if (options_.seconds > 0 && clock_.Seconds() > options_.seconds) {
      late_ = stopped_ = true;
    }
    if (options_.progress && std::this_thread::get_id() == caller_ &&
        !options_.progress("knots", fraction)) {
      cancelled_ = stopped_ = true;
    }
    return stopped_;
  }

  double fraction = 0;  // changed between stages
  bool cancelled() const { return cancelled_; }
  bool late() const { return late_; }

 private:
  const FreeKnotOptions& options_;
  std::thread::id caller_;
  Stopwatch clock_;
  std::atomic<bool> stopped_ = false, cancelled_ = false, late_ = false;
};

int Functions(const MovingKnots& knots) {
  return (knots.u.basis().degree() + 1) * (knots.v ? knots.v->basis().degree() + 1 : 1);
}

double WorkOf(const VariableProjection& projection, const MovingKnots& knots) {
  return static_cast<double>(projection.values()) * Functions(knots) +
         kKnotsCubed * std::pow(knots.free(), 3);
}

// The number of data that suffices to place knots.
Eigen::Index SearchedData(const MovingKnots& knots) {
  return std::max<Eigen::Index>(knots.v ? 4000 : 1000, Eigen::Index{20} * knots.unknowns());
}

// The given knots, insertion, random starts and exchanges, sorted.
std::vector<Descent> Search(const VariableProjection& data,
                            const MovingKnots& given,
                            const FreeKnotOptions& options,
                            const DescentOptions& descent,
                            Watch& watch,
                            ThreadPool& pool,
                            FreeKnotResult& result) {
  const double work = WorkOf(data, given);
  KnotSearch search(data, descent, work <= kSideBySide, pool);
  DescentOptions rough = descent;
  rough.tolerance = kRough;
  std::vector<Descent> all;
  const auto add = [&](const std::vector<Descent>& more, double fraction) {
    all.insert(all.end(), more.begin(), more.end());
    all = SortedDescents(std::move(all));
    watch.fraction = fraction;
    return !watch.Stop() && (all.empty() || all[0].cost > descent.stop_squares);
  };
  const auto run = [&] {
    if (!add(search.DescendAll({given}, rough), 0.1)) return;
    const int tried = static_cast<int>(
        std::clamp(kWork / (kIterationsOfOne * work * std::min(16, given.free())), 2.0, 6.0));
    if (!add(search.Insert(given, tried > 3 ? 2 : 1, tried), 0.4)) return;
    const int starts = static_cast<int>(std::lround(
        options.starts * std::min({1.0, kFullSearch / work, kFullyStarted / given.free()})));
    if (!add(search.DescendAll(search.RandomStarts(given, starts, options.seed), rough), 0.6))
      return;
    if (all.empty()) return;
    const int budget = static_cast<int>(kWork / work);
    add({search.Improve(all[0], budget)}, 0.7);
    // Here and not on all data where that would be dear.
    if (work > kFullSearch) all.insert(all.begin(), search.CloseGaps(all[0], kNarrow, budget));
  };
  run();
  result.iterations += search.iterations();
  result.starts += search.starts();
  return all;
}

FittingProblem Over(const FittingProblem& problem, const MovingKnots& knots) {
  return knots.v ? problem.WithBases(knots.u.basis(), knots.v->basis())
                 : problem.WithBasis(knots.u.basis());
}

void Require(bool good, const char* rule) {
  if (!good) Reject("OptimizeKnots", rule);
}

FreeKnotResult OptimizeScaledKnots(const FittingProblem& problem,
                                   const FreeKnotOptions& options,
                                   ThreadPool& pool) {
  MovingKnots given{KnotGaps(problem.basis_u()), std::nullopt, options.u, false};
  if (!problem.is_curve()) {
    given.v.emplace(problem.basis_v());
    given.move_v = options.v;
  }
  if ((given.move_u && problem.basis_u().periodic()) ||
      (given.move_v && problem.basis_v().periodic()))
    Reject("OptimizeKnots", "the knots of a periodic basis cannot move");

  FreeKnotResult result{problem, SolveLinear(problem, pool), 0, 0, 0, 0, false, ""};
  result.squares_before = result.squares_after = result.solution.residual_squares;
  if (given.free() == 0) {
    result.note = "no interior knot may move";
    return result;
  }
  if (result.squares_before <= options.stop_squares) {
    result.note = "the given knots are good enough";
    return result;
  }

  Watch watch(options);
  const VariableProjection whole(problem);
  DescentOptions descent;
  descent.max_iterations = options.max_iterations;
  descent.coalesce = options.coalesce;
  descent.stop_squares = options.stop_squares;
  descent.stop = [&watch] { return watch.Stop(); };

  // Places to start from, sought on part of the data when there are many.
  const VariableProjection part = whole.Thinned(SearchedData(given));
  DescentOptions rough = descent;
  rough.stop_squares *= static_cast<double>(part.size()) / static_cast<double>(whole.size());
  const std::vector<Descent> found = Search(part, given, options, rough, watch, pool, result);

  // The best of them to the end, on all data.
  const double work = WorkOf(whole, given);
  if (work > kCheap) descent.tolerance = kRough;
  KnotSearch search(whole, descent, work <= kSideBySide, pool);
  std::vector<Descent> polished;
  watch.fraction = 0.8;
  if (!watch.Stop()) {
    polished = SortedDescents(
        search.DescendAll(DifferentKnots(found, work <= kFullSearch ? kPolished : 1), descent));
    if (!polished.empty() && work <= kCheap)
      polished.insert(polished.begin(),
                      search.CloseGaps(polished[0], kNarrow, static_cast<int>(kWork / work)));
  }
  result.iterations += search.iterations();
  result.starts += search.starts();

  // In order of preference; the first that is better than the start.
  std::vector<Descent> candidates = std::move(polished);
  candidates.insert(candidates.end(), found.begin(), found.end());
  for (const Descent& d : candidates) {
    const FittingProblem moved = Over(problem, d.knots);
    LinearSolution solution = SolveLinear(moved, pool);
    if (!(solution.residual_squares < result.squares_before)) continue;
    result.problem = moved;
    result.squares_after = solution.residual_squares;
    result.solution = std::move(solution);
    break;
  }
  result.cancelled = watch.cancelled();
  if (watch.cancelled()) {
    result.note = "cancelled";
  } else if (watch.late()) {
    result.note = "time limit reached";
  } else if (candidates.empty()) {
    result.note = "the data do not determine the coefficients, wherever the knots are";
  }
  return result;
}

}  // namespace

void Check(const FreeKnotOptions& options) {
  Require(options.max_iterations >= 0, "max_iterations is negative");
  Require(options.starts >= 0, "starts is negative");
  Require(options.coalesce >= 0 && options.coalesce <= 0.1, "coalesce is not in [0, 0.1]");
  Require(options.stop_squares >= 0, "stop_squares is negative or not a number");
  Require(options.seconds >= 0, "seconds is negative or not a number");
}

FreeKnotResult OptimizeKnots(const FittingProblem& problem,
                             const FreeKnotOptions& options,
                             ThreadPool& pool) {
  Check(options);
  const double unit = UnitOf(problem.data().values);
  auto data = std::make_shared<FittingData>(problem.data());
  data->values /= unit;
  FreeKnotOptions scaled = options;
  scaled.stop_squares /= unit * unit;
  FreeKnotResult result = OptimizeScaledKnots(problem.WithData(std::move(data)), scaled, pool);
  result.problem = result.problem.WithData(problem.shared_data());
  result.solution.coefficients *= unit;
  result.solution.residual_squares *= unit * unit;
  result.squares_before *= unit * unit;
  result.squares_after *= unit * unit;
  return result;
}

}  // namespace batten
