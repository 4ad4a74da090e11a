// SPDX-License-Identifier: MIT
#include "fitting/knots/knot_search.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>

#include "fitting/core/rounding.h"
#include "fitting/least_squares/fitting_bases.h"

namespace batten::internal {
namespace {

// Limits that only many knots meet: spans that an insertion is tried in, and knots exchanged.
constexpr size_t kTriedSpans = 16, kExchanged = 12;

// Indices of the least costs, in increasing order of cost, then of index.
std::vector<size_t> Cheapest(const std::vector<double>& costs, size_t count) {
  std::vector<size_t> order(costs.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::stable_sort(
      order.begin(), order.end(), [&](size_t a, size_t b) { return costs[a] < costs[b]; });
  while (!order.empty() && !std::isfinite(costs[order.back()])) order.pop_back();
  if (order.size() > count) order.resize(count);
  return order;
}

// The knots inside the open domain, with repetition.
std::vector<double> InteriorKnots(const SplineBasis& basis) {
  std::vector<double> interior;
  for (const double t : basis.knots()) {
    if (t > basis.lower() && t < basis.upper()) interior.push_back(t);
  }
  return interior;
}

// Others in their place.
KnotGaps WithInteriorKnots(const KnotGaps& gaps, const std::vector<double>& interior) {
  const SplineBasis& basis = gaps.basis();
  std::vector<double> knots = basis.knots();
  std::erase_if(knots, [&](double t) { return t > basis.lower() && t < basis.upper(); });
  return KnotGaps(WithInnerKnots(SplineBasis(basis.degree(), std::move(knots)), interior));
}

KnotGaps WithoutKnot(const KnotGaps& gaps, size_t index) {
  std::vector<double> interior = InteriorKnots(gaps.basis());
  interior.erase(interior.begin() + static_cast<std::ptrdiff_t>(index));
  return WithInteriorKnots(gaps, interior);
}

// The number of knots still to be inserted.
int MissingIn(const MovingKnots& knots, const MovingKnots& wanted, bool u) {
  if (u) return wanted.move_u ? wanted.u.basis().size() - knots.u.basis().size() : 0;
  return wanted.v && wanted.move_v ? wanted.v->basis().size() - knots.v->basis().size() : 0;
}

int Missing(const MovingKnots& knots, const MovingKnots& wanted) {
  return MissingIn(knots, wanted, true) + MissingIn(knots, wanted, false);
}

double UniformReal(std::mt19937_64& generator) {
  return static_cast<double>(generator() >> 11) * 0x1p-53;
}

// Draws as many increasing random numbers in the open domain as the basis has interior knots.
KnotGaps RandomKnots(const KnotGaps& gaps, std::mt19937_64& generator) {
  std::vector<double> interior = InteriorKnots(gaps.basis());
  for (;;) {
    for (double& t : interior) t = gaps.basis().lower() + gaps.length() * UniformReal(generator);
    std::sort(interior.begin(), interior.end());
    double last = gaps.basis().lower();
    bool apart = true;
    for (const double t : interior) {
      apart = apart && t > last && t < gaps.basis().upper();
      last = t;
    }
    if (apart) return WithInteriorKnots(gaps, interior);
  }
}

// The data, and how much is done at a time: side by side, each on a thread of its own, or one after
// another on the whole pool.
struct Measures {
  const VariableProjection& projection;
  bool side_by_side;
  ThreadPool& pool;

  // Calls task(i, pool) for every i.
  void ForEach(size_t count, std::ptrdiff_t block, const auto& task) const {
    if (!side_by_side) {
      for (size_t i = 0; i < count; ++i) task(i, pool);
      return;
    }
    pool.For(
        static_cast<std::ptrdiff_t>(count), block, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
          ThreadPool own(1);
          for (std::ptrdiff_t i = begin; i < end; ++i) task(static_cast<size_t>(i), own);
        });
  }
};

// A knot put into span number `span` of a state's u or v.
struct Trial {
  size_t state;
  bool in_u;
  int span;
  double knot;
  MovingKnots knots;  // the state with the knot
};

std::vector<double> CostOf(const Measures& on, const std::vector<Trial>& trials) {
  std::vector<double> costs(trials.size(), std::numeric_limits<double>::infinity());
  on.ForEach(costs.size(), 4, [&](size_t i, ThreadPool& pool) {
    const auto value = on.projection.Evaluate(trials[i].knots, pool);
    if (value) costs[i] = value->cost;
  });
  return costs;
}

// Adds a knot in each of the `count` worst spans of the directions named.
void AddTrials(const Measures& on,
               const MovingKnots& knots,
               size_t state,
               bool in_u,
               bool in_v,
               size_t count,
               std::vector<Trial>& trials) {
  const auto errors = on.projection.Errors(knots, on.pool);
  if (!errors) return;
  const auto add = [&](const std::vector<VariableProjection::SpanError>& spans, bool u) {
    // Between a knot that is tried and its neighbours.
    const double room = kRelativelyEqual * (u ? knots.u : *knots.v).length();
    std::vector<double> order;
    for (const auto& span : spans) order.push_back(-span.squares);
    std::vector<size_t> worst = Cheapest(order, count);
    std::sort(worst.begin(), worst.end());
    for (const size_t s : worst) {
      const double middle = (spans[s].lower + spans[s].upper) / 2;
      for (const double t : {spans[s].centroid, middle}) {
        if (!(t - spans[s].lower > room) || !(spans[s].upper - t > room)) continue;
        trials.push_back({state, u, static_cast<int>(s), t, knots});
        KnotGaps& gaps = u ? trials.back().knots.u : *trials.back().knots.v;
        gaps = KnotGaps(WithInnerKnots(gaps.basis(), {t}));
      }
    }
  };
  if (in_u) add(errors->u, true);
  if (in_v) add(errors->v, false);
}

// The least needed knots, each moved to its best place.
std::vector<MovingKnots> Exchanges(const Measures& on, const MovingKnots& knots, bool in_u) {
  const KnotGaps& gaps = in_u ? knots.u : *knots.v;
  const std::vector<double> interior = InteriorKnots(gaps.basis());
  std::vector<MovingKnots> exchanges;
  std::vector<Trial> without;
  for (size_t i = 0; i < interior.size(); ++i) {
    if (i > 0 && interior[i] == interior[i - 1]) continue;
    without.push_back({0, in_u, 0, interior[i], knots});
    KnotGaps& fewer = in_u ? without.back().knots.u : *without.back().knots.v;
    fewer = WithoutKnot(gaps, i);
  }
  for (const size_t i : Cheapest(CostOf(on, without), kExchanged)) {
    std::vector<Trial> trials;
    AddTrials(on, without[i].knots, 0, in_u, !in_u, kTriedSpans, trials);
    for (const size_t t : Cheapest(CostOf(on, trials), 1)) exchanges.push_back(trials[t].knots);
  }
  return exchanges;
}

}  // namespace

std::vector<Descent> SortedDescents(std::vector<Descent> descents) {
  std::erase_if(descents, [](const Descent& d) { return !std::isfinite(d.cost); });
  std::stable_sort(descents.begin(), descents.end(), [](const Descent& a, const Descent& b) {
    return a.cost < b.cost;
  });
  return descents;
}

std::vector<MovingKnots> DifferentKnots(const std::vector<Descent>& sorted, int count) {
  std::vector<MovingKnots> chosen;
  double last = 0;
  for (const Descent& d : sorted) {
    if (static_cast<int>(chosen.size()) == count) break;
    if (!chosen.empty() && !(d.cost > last * 1.001)) continue;
    chosen.push_back(d.knots);
    last = d.cost;
  }
  return chosen;
}

KnotSearch::KnotSearch(const VariableProjection& projection,
                       const DescentOptions& descent,
                       bool parallel_starts,
                       ThreadPool& pool)
    : projection_(projection), options_(descent), parallel_starts_(parallel_starts), pool_(pool) {}

std::vector<Descent> KnotSearch::DescendAll(const std::vector<MovingKnots>& starts,
                                            const DescentOptions& options) {
  std::vector<Descent> results;
  for (const MovingKnots& start : starts)
    results.push_back({start, std::numeric_limits<double>::infinity(), 0});
  Measures{projection_, parallel_starts_, pool_}.ForEach(
      starts.size(), 1, [&](size_t i, ThreadPool& pool) {
        results[i] = Descend(projection_, starts[i], options, pool);
      });
  for (const Descent& result : results) iterations_ += result.iterations;
  starts_ += static_cast<int>(starts.size());
  return results;
}

std::vector<Descent> KnotSearch::Insert(const MovingKnots& wanted, int kept, int tried) {
  constexpr size_t kLevels = 16;
  const Measures on{projection_, parallel_starts_, pool_};
  MovingKnots none = wanted;
  if (wanted.move_u) none.u = WithInteriorKnots(wanted.u, {});
  if (wanted.v && wanted.move_v) none.v = WithInteriorKnots(*wanted.v, {});
  const size_t a_level = std::max<size_t>(1, Missing(none, wanted) / kLevels);
  std::vector<MovingKnots> states{none};
  for (;;) {
    std::vector<Trial> trials;
    for (size_t s = 0; s < states.size(); ++s) {
      AddTrials(on,
                states[s],
                s,
                MissingIn(states[s], wanted, true) > 0,
                MissingIn(states[s], wanted, false) > 0,
                std::max(kTriedSpans, 2 * a_level),
                trials);
    }
    const std::vector<size_t> ranking = Cheapest(CostOf(on, trials), trials.size());
    if (ranking.empty()) return {};
    std::vector<MovingKnots> chosen;
    for (size_t c = 0; c < std::min(ranking.size(), static_cast<size_t>(tried)); ++c) {
      const Trial& first = trials[ranking[c]];
      chosen.push_back(first.knots);
      // More of them, in other spans of the same state.
      std::vector<std::pair<bool, int>> used{{first.in_u, first.span}};
      for (const size_t i : ranking) {
        const Trial& next = trials[i];
        if (used.size() == a_level) break;
        if (next.state != first.state || MissingIn(chosen.back(), wanted, next.in_u) == 0 ||
            std::find(used.begin(), used.end(), std::pair(next.in_u, next.span)) != used.end())
          continue;
        KnotGaps& gaps = next.in_u ? chosen.back().u : *chosen.back().v;
        gaps = KnotGaps(WithInnerKnots(gaps.basis(), {next.knot}));
        used.emplace_back(next.in_u, next.span);
      }
    }
    const bool last = Missing(chosen[0], wanted) == 0;
    DescentOptions coarse = options_;
    coarse.tolerance = last ? 1e-6 : 1e-3;
    coarse.max_iterations = std::min(options_.max_iterations, last ? 100 : 30);
    const std::vector<Descent> results = DescendAll(chosen, coarse);
    if (last) {
      std::vector<Descent> whole = results;
      std::erase_if(whole, [&](const Descent& d) { return Missing(d.knots, wanted) > 0; });
      return whole;
    }
    states = DifferentKnots(SortedDescents(results), kept);
    if (states.empty() || (options_.stop && options_.stop())) return {};
  }
}

std::vector<MovingKnots> KnotSearch::RandomStarts(const MovingKnots& wanted,
                                                  int count,
                                                  std::uint64_t seed) {
  constexpr int kDraws = 8;
  std::vector<MovingKnots> starts;
  for (int s = 0; s < count; ++s) {
    // Every start has numbers of its own, so that the first of many are those of few.
    std::mt19937_64 generator(seed * 0x9E3779B97F4A7C15u + static_cast<std::uint64_t>(s));
    for (int draw = 0; draw < kDraws; ++draw) {
      MovingKnots knots = wanted;
      if (wanted.free_u() > 0) knots.u = RandomKnots(wanted.u, generator);
      if (wanted.free_v() > 0) knots.v = RandomKnots(*wanted.v, generator);
      if (!projection_.Evaluate(knots, pool_)) continue;
      starts.push_back(std::move(knots));
      break;
    }
  }
  return starts;
}

namespace {

// The knots with one pair of neighbours merged, for the narrowest pairs, all nearer than `share` of
// the domain.
std::vector<MovingKnots> Merges(const MovingKnots& knots, double share) {
  std::vector<MovingKnots> merges;
  std::vector<double> widths;
  for (const bool in_u : {true, false}) {
    if ((in_u ? knots.free_u() : knots.free_v()) == 0) continue;
    const KnotGaps& gaps = in_u ? knots.u : *knots.v;
    for (int g = 0; g + 1 < gaps.groups(); ++g) {
      const double width = (gaps.knot(g + 1) - gaps.knot(g)) / gaps.length();
      auto merged = gaps.Merged(g);
      if (!(width < share) || !merged) continue;
      merges.push_back(knots);
      (in_u ? merges.back().u : *merges.back().v) = std::move(*merged);
      widths.push_back(width);
    }
  }
  std::vector<MovingKnots> narrowest;
  for (const size_t i : Cheapest(widths, kExchanged)) narrowest.push_back(merges[i]);
  return narrowest;
}

// The first of the least, or none.
const Descent* Least(const std::vector<Descent>& results) {
  const auto least =
      std::min_element(results.begin(), results.end(), [](const Descent& a, const Descent& b) {
        return a.cost < b.cost;
      });
  return least == results.end() ? nullptr : &*least;
}

// Iterations of a trial descent that ranks a start.
constexpr int kFewIterations = 10;

// Relative change of Φ: a larger fall counts as lower, a smaller rise as no higher.
constexpr double kLower = 1e-4;

}  // namespace

Descent KnotSearch::Improve(Descent best, int most_iterations) {
  const Measures on{projection_, parallel_starts_, pool_};
  DescentOptions coarse = options_;
  coarse.tolerance = 1e-6;
  const int end = iterations_ + most_iterations;
  while (iterations_ < end && !(options_.stop && options_.stop())) {
    std::vector<MovingKnots> starts = Merges(best.knots, 1);
    for (const bool in_u : {true, false}) {
      if ((in_u ? best.knots.free_u() : best.knots.free_v()) == 0) continue;
      for (auto& exchange : Exchanges(on, best.knots, in_u)) starts.push_back(std::move(exchange));
    }
    const int each = most_iterations / std::max(1, static_cast<int>(starts.size()));
    coarse.max_iterations = std::min(options_.max_iterations, std::max(kFewIterations, each));
    const std::vector<Descent> results = DescendAll(starts, coarse);
    const Descent* least = Least(results);
    if (!least || !(least->cost < best.cost * (1 - kLower))) break;
    best = *least;
  }
  return best;
}

Descent KnotSearch::CloseGaps(Descent best, double share, int most_iterations) {
  constexpr int kLeastIterations = 5;  // of a descent
  const int end = iterations() + most_iterations;
  while (!(options_.stop && options_.stop())) {
    const std::vector<MovingKnots> merges = Merges(best.knots, share);
    const int each = (end - iterations()) / std::max(1, static_cast<int>(std::ssize(merges)));
    if (merges.empty() || each < kLeastIterations) break;
    DescentOptions bounded = options_;
    bounded.max_iterations = std::min(options_.max_iterations, each);
    const std::vector<Descent> results = DescendAll(merges, bounded);
    const Descent* least = Least(results);
    if (!least || !(least->cost <= best.cost * (1 + kLower))) break;
    best = *least;
  }
  return best;
}

}  // namespace batten::internal
