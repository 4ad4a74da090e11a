// SPDX-License-Identifier: MIT
#include "geometry/editing/knot_refinement.h"
#include "geometry/numeric/constants.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <iterator>
#include <limits>
#include <utility>

namespace batten::internal {
namespace {

// Old and new knots in one increasing list.
struct MergedKnots {
  std::vector<double> knots;
  std::vector<int> old_before;  // old_before[k]: how many of the first k are old; one entry more

  bool IsOld(int k) const { return old_before[k + 1] > old_before[k]; }
  int PlaceOfOld(int i) const {
    return static_cast<int>(std::upper_bound(old_before.begin(), old_before.end(), i) -
                            old_before.begin()) -
           1;
  }
};

// New knots stand in front of the old ones of the same value, behind them where it is `behind`: at
// the lower end of an unclamped domain only that side has the control points it takes.
MergedKnots Merge(const std::vector<double>& old, std::span<const double> more, double behind) {
  MergedKnots merged;
  merged.old_before.push_back(0);
  size_t next = 0;
  const auto add = [&](double knot, int is_old) {
    merged.knots.push_back(knot);
    merged.old_before.push_back(merged.old_before.back() + is_old);
  };
  for (const double x : more) {
    while (next < old.size() && (old[next] < x || (old[next] == x && x == behind))) {
      add(old[next++], 1);
    }
    add(x, 0);
  }
  while (next < old.size()) add(old[next++], 1);
  return merged;
}

// The coefficients of old control points first … first + count − 1 in a new one.
struct Blend {
  int first, count;
  double c[kMaxDegree + 1];
};

// The blossom at merged knots j+1 … j+p. Level k leads from arguments (p − k + 1 old knots, k − 1
// new) to (p − k old, k new); it is run backwards, from the result to the old control points.
// x_k = (1 − a)·u_i + a·u_{i+p−k+1}.
Blend BlendOf(int p, const std::vector<double>& U, const MergedKnots& merged, int j) {
  double x[kMaxDegree];
  int r = 0;
  for (int k = j + 1; k <= j + p; ++k) {
    if (!merged.IsOld(k)) x[r++] = merged.knots[k];
  }
  const int l = merged.old_before[j + 1] - 1;  // the last old knot up to j
  Blend blend{l - r, r + 1, {1}};
  double* c = blend.c;
  for (int k = r; k >= 1; --k) {
    c[r - k + 1] = 0;
    for (int o = r - k; o >= 0; --o) {
      const int i = l - (r - k) + o;
      const double above = U[i + p - k + 1] - x[k - 1], below = x[k - 1] - U[i];
      const double length = U[i + p - k + 1] - U[i];
      c[o + 1] += c[o] * (below / length);
      c[o] *= above / length;
    }
  }
  return blend;
}

// Blends differences from the point that counts most, so that rounding is relative to the range of
// the points and not to their distance from the origin.
void SetBlended(const ControlRows& from, const Blend& blend, Eigen::Index to, ControlRows& result) {
  const int largest = static_cast<int>(std::max_element(blend.c, blend.c + blend.count) - blend.c);
  const Eigen::Index reference = blend.first + largest;
  if (from.rational()) {
    result.weights.col(to) = blend.c[0] * from.weights.col(blend.first);
    for (int k = 1; k < blend.count; ++k) {
      result.weights.col(to) += blend.c[k] * from.weights.col(blend.first + k);
    }
  }
  Eigen::ArrayXd sum(from.rows());
  for (int d = 0; d < from.dimension(); ++d) {
    const Eigen::MatrixXd& x = from.coordinates[d];
    sum.setZero();
    for (int k = 0; k < blend.count; ++k) {
      if (k == largest) continue;
      const Eigen::Index i = blend.first + k;
      const auto difference = x.col(i).array() - x.col(reference).array();
      if (from.rational()) {
        sum += blend.c[k] * from.weights.col(i).array() * difference;
      } else {
        sum += blend.c[k] * difference;
      }
    }
    if (from.rational()) sum /= result.weights.col(to).array();
    result.coordinates[d].col(to) = x.col(reference).array() + sum;
  }
}

// The control points over `basis`, whose knots are the merged ones from place `first` on, the
// outermost at each end perhaps changed.
ControlRows Blended(const ControlRows& rows,
                    const MergedKnots& merged,
                    int first,
                    SplineBasis basis) {
  ControlRows result = EmptyRows(rows, std::move(basis));
  const int p = rows.basis.degree();
  for (int j = 0; j < result.basis.size(); ++j) {
    SetBlended(rows, BlendOf(p, rows.basis.knots(), merged, first + j), j, result);
  }
  return result;
}

// Appends the places of the knot vector where x, of the domain, is to be inserted: x and all its
// copies whole periods away. Each keeps its distance from the knot next to it.
void AppendCopies(const SplineBasis& basis, double x, std::vector<double>& places) {
  const std::vector<double>& U = basis.knots();
  const int m = basis.size() - basis.degree(), last = static_cast<int>(U.size()) - 1;
  if (x == basis.upper()) x = basis.lower();
  const int at = static_cast<int>(std::lower_bound(U.begin(), U.end(), x) - U.begin());
  if (U[at] == x) {
    for (int i = at % m; i <= last; i += m) places.push_back(U[i]);
    return;
  }
  for (int i = (at - 1) % m; i < last; i += m) {
    const double copy =
        x - U[at - 1] <= U[at] - x ? U[i] + (x - U[at - 1]) : U[i + 1] - (U[at] - x);
    // Rounding must not put it on a knot, where the number of knots in a period would change.
    const double low = std::nextafter(U[i], kInfinity), high = std::nextafter(U[i + 1], -kInfinity);
    places.push_back(i == at - 1 ? x : std::clamp(copy, std::min(low, high), std::max(low, high)));
  }
}

ControlRows RefinedPeriodic(const ControlRows& rows, std::span<const double> more) {
  const SplineBasis& basis = rows.basis;
  const int p = basis.degree();
  std::vector<double> places;
  for (const double x : more) AppendCopies(basis, x, places);
  std::sort(places.begin(), places.end());
  constexpr double kNowhere = std::numeric_limits<double>::quiet_NaN();
  const MergedKnots merged = Merge(basis.knots(), places, kNowhere);
  const int begin = merged.PlaceOfOld(p), end = merged.PlaceOfOld(basis.size());
  std::vector<double> knots(merged.knots.begin() + begin - p, merged.knots.begin() + end + p + 1);
  return Blended(rows, merged, begin - p, SplineBasis::Periodic(p, std::move(knots)));
}

}  // namespace

ControlRows Refined(const ControlRows& rows, std::span<const double> more) {
  if (more.empty()) return rows;
  if (rows.basis.periodic()) return RefinedPeriodic(rows, more);
  MergedKnots merged = Merge(rows.basis.knots(), more, rows.basis.lower());
  return Blended(rows, merged, 0, SplineBasis(rows.basis.degree(), merged.knots));
}

ControlRows Cut(const ControlRows& rows, double from, double to, std::span<const double> more) {
  const SplineBasis& basis = rows.basis;
  const int p = basis.degree();
  std::vector<double> places;
  for (int k = basis.Multiplicity(from); k < p; ++k) places.push_back(from);
  places.insert(places.end(), more.begin(), more.end());
  for (int k = basis.Multiplicity(to); k < p; ++k) places.push_back(to);
  const MergedKnots merged = Merge(basis.knots(), places, basis.lower());
  const auto inner = std::upper_bound(merged.knots.begin(), merged.knots.end(), from);
  const auto outer = std::lower_bound(inner, merged.knots.end(), to);
  std::vector<double> knots(p + 1, from);
  knots.insert(knots.end(), inner, outer);
  knots.insert(knots.end(), p + 1, to);
  const int first = static_cast<int>(inner - merged.knots.begin()) - p - 1;
  return Blended(rows, merged, first, SplineBasis(p, std::move(knots)));
}

ControlRows BezierRows(const ControlRows& rows, std::span<const double> breaks) {
  const SplineBasis& basis = rows.basis;
  const std::vector<double>& U = basis.knots();
  std::vector<double> inner;
  std::merge(U.begin(), U.end(), breaks.begin(), breaks.end(), std::back_inserter(inner));
  inner.erase(std::unique(inner.begin(), inner.end()), inner.end());
  std::vector<double> more;
  for (const double knot : inner) {
    if (knot <= basis.lower() || knot >= basis.upper()) continue;
    for (int k = basis.Multiplicity(knot); k < basis.degree(); ++k) more.push_back(knot);
  }
  return Cut(rows, basis.lower(), basis.upper(), more);
}

std::vector<double> EndlessKnots(const SplineBasis& basis, int first, int last) {
  const std::vector<double>& U = basis.knots();
  const int m = basis.size() - basis.degree(), count = static_cast<int>(U.size());
  const double period = basis.upper() - basis.lower();
  // What is equal stays equal, and what is rounded stays in order.
  std::deque<double> all(U.begin(), U.end());
  for (int i = count; i <= last; ++i) {
    const double base = all[i - m], previous = all[i - 1];
    all.push_back(base == all[i - m - 1] ? previous : std::max(previous, base + period));
  }
  for (int i = -1; i >= first; --i) {
    const double base = all[m - 1], next = all.front();
    all.push_front(base == all[m] ? next : std::min(next, base - period));
  }
  const auto begin = all.begin() + std::max(first, 0);
  return std::vector<double>(begin, begin + (last - first + 1));
}

ControlRows UnrolledTwice(const ControlRows& rows) {
  const SplineBasis& basis = rows.basis;
  const int p = basis.degree(), m = basis.size() - p;
  ControlRows result = EmptyRows(rows, SplineBasis(p, EndlessKnots(basis, 0, 2 * (m + p))));
  for (int i = 0; i < result.basis.size(); ++i) {
    for (int d = 0; d < rows.dimension(); ++d) {
      result.coordinates[d].col(i) = rows.coordinates[d].col(i % m);
    }
    if (rows.rational()) result.weights.col(i) = rows.weights.col(i % m);
  }
  return result;
}

}  // namespace batten::internal
