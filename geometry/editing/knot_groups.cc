// SPDX-License-Identifier: MIT
#include "geometry/editing/knot_groups.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace batten::internal {
namespace {

constexpr int kMargin = kMaxDegree + 1;  // knots that may be needed beyond an end of the domain

void Append(KnotGroups& groups, double value, int count) {
  groups.values.push_back(value);
  groups.counts.push_back(count);
}

// The copies of the domain's ends that lie inside it.
void CountInside(const SplineBasis& basis, KnotGroups& groups) {
  const std::vector<double>& U = basis.knots();
  const int p = basis.degree(), n = basis.size();
  while (U[p + groups.after_lower + 1] == U[p]) ++groups.after_lower;
  while (U[n - groups.before_upper - 1] == U[n]) ++groups.before_upper;
}

KnotGroups GroupOpen(const SplineBasis& basis) {
  KnotGroups groups{};
  CountInside(basis, groups);
  for (const double knot : basis.knots()) {
    if (groups.values.empty() || groups.values.back() != knot) Append(groups, knot, 0);
    ++groups.counts.back();
    if (knot == basis.lower()) groups.lower = static_cast<int>(groups.values.size()) - 1;
    if (knot == basis.upper()) groups.upper = static_cast<int>(groups.values.size()) - 1;
  }
  return groups;
}

// One group of a period: its copies are the knots first … last, and those whole periods away.
struct RoundGroup {
  int first, last;
};

// The groups of one period, judged by the knots from u_p to u_n, which are the ones that count.
std::vector<RoundGroup> Round(const SplineBasis& basis, const KnotGroups& inside) {
  const std::vector<double>& U = basis.knots();
  const int p = basis.degree();
  std::vector<RoundGroup> round(1, {p - inside.before_upper, p + inside.after_lower});
  for (int i = p + inside.after_lower + 1; i < basis.size() - inside.before_upper; ++i) {
    if (U[i] == U[i - 1]) {
      round.back().last = i;
    } else {
      round.push_back({i, i});
    }
  }
  return round;
}

KnotGroups GroupPeriodic(const SplineBasis& basis) {
  const std::vector<double>& U = basis.knots();
  const int p = basis.degree(), n = basis.size(), distinct = n - p;
  KnotGroups groups{};
  groups.periodic = true;
  CountInside(basis, groups);
  const std::vector<RoundGroup> round = Round(basis, groups);
  const int size = static_cast<int>(round.size()), turns = kMargin / size + 1;
  for (int turn = -turns; turn <= turns + 1; ++turn) {
    for (int g = 0; g < size; ++g) {
      // The copy nearest to the domain: where the basis has any, it has this one.
      const bool end = g == 0 && (turn == 0 || turn == 1);
      int i = end ? p : turn < 0 ? round[g].last : round[g].first;
      const double here = U[i];
      i += turn * distinct;
      const bool known = i >= 0 && i < static_cast<int>(U.size());
      Append(groups,
             known ? U[i] : here + turn * (basis.upper() - basis.lower()),
             round[g].last - round[g].first + 1);
    }
  }
  groups.lower = turns * size;
  groups.upper = groups.lower + size;
  return groups;
}

// How many knots are missing in the groups first … last, of which `inside` do not count.
int Missing(const KnotGroups& groups, int first, int last, int inside, int needed) {
  const auto counts = groups.counts.begin();
  return needed - std::accumulate(counts + first, counts + last + 1, -inside);
}

// Gives so many copies back to the groups first … last, each to the one that has lost the greatest
// part of what it had.
void Restore(KnotGroups& groups, const KnotGroups& old, int first, int last, int missing) {
  for (; missing > 0; --missing) {
    int most = first;
    for (int g = first; g <= last; ++g) {
      if (groups.counts[g] * old.counts[most] < groups.counts[most] * old.counts[g]) most = g;
    }
    ++groups.counts[most];
  }
}

}  // namespace

KnotGroups GroupKnots(const SplineBasis& basis) {
  return basis.periodic() ? GroupPeriodic(basis) : GroupOpen(basis);
}

SplineBasis BasisOfGroups(const KnotGroups& groups, int degree) {
  const size_t margin = static_cast<size_t>(degree) + 1;
  std::vector<double> left, knots, right;
  left.assign(groups.counts[groups.lower] - groups.after_lower, groups.values[groups.lower]);
  for (int g = groups.lower - 1; left.size() < margin; --g) {
    left.insert(left.end(), groups.counts[g], groups.values[g]);
  }
  knots.assign(groups.after_lower, groups.values[groups.lower]);
  for (int g = groups.lower + 1; g < groups.upper; ++g) {
    knots.insert(knots.end(), groups.counts[g], groups.values[g]);
  }
  knots.insert(knots.end(), groups.before_upper, groups.values[groups.upper]);
  right.assign(groups.counts[groups.upper] - groups.before_upper, groups.values[groups.upper]);
  for (int g = groups.upper + 1; right.size() < margin; ++g) {
    right.insert(right.end(), groups.counts[g], groups.values[g]);
  }
  left.resize(margin);
  right.resize(margin);
  knots.insert(knots.begin(), left.rbegin(), left.rend());
  knots.insert(knots.end(), right.begin(), right.end());
  return groups.periodic ? SplineBasis::Periodic(degree, std::move(knots))
                         : SplineBasis(degree, std::move(knots));
}

KnotGroups RaisedMultiplicities(KnotGroups groups) {
  for (int& count : groups.counts) ++count;
  if (groups.periodic) ++groups.before_upper;
  return groups;
}

KnotGroups LoweredMultiplicities(KnotGroups groups, int degree, int by) {
  const KnotGroups old = groups;
  std::vector<int>& counts = groups.counts;
  for (int& count : counts) count = std::max(count - by, 1);
  groups.after_lower = std::min(groups.after_lower, counts[groups.lower] - 1);
  if (groups.periodic) {
    groups.before_upper = counts[groups.lower] - 1 - groups.after_lower;
    return groups;
  }
  groups.before_upper = std::min(groups.before_upper, counts[groups.upper] - 1);
  const int needed = degree - by + 1, last = static_cast<int>(counts.size()) - 1;
  if (Missing(groups, 0, groups.lower, groups.after_lower, needed) > 0) {
    groups.after_lower = 0;
    const int missing = Missing(groups, 0, groups.lower, 0, needed);
    Restore(groups, old, 0, groups.lower, missing);
  }
  if (Missing(groups, groups.upper, last, groups.before_upper, needed) > 0) {
    groups.before_upper = 0;
    const int missing = Missing(groups, groups.upper, last, 0, needed);
    Restore(groups, old, groups.upper, last, missing);
  }
  return groups;
}

}  // namespace batten::internal
