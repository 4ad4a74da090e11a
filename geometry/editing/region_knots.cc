// SPDX-License-Identifier: MIT
#include "geometry/editing/region_knots.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "geometry/editing/control_forms.h"
#include "geometry/numeric/number_text.h"
#include "geometry/numeric/reject.h"

namespace batten::internal {
namespace {

constexpr double kSame = 1e-9;  // of the range's length: knots this near are one

}  // namespace

void CheckRange(const SplineBasis& basis,
                const ParameterRange& range,
                const std::string& function,
                const std::string& name) {
  if (!(range.from < range.to)) {
    Reject(function,
           "the range " + IntervalText(range.from, range.to) + " of " + name + " is empty");
  }
  if (range.from >= basis.lower() && range.to <= basis.upper()) return;
  Reject(function,
         "the range " + IntervalText(range.from, range.to) + " of " + name + " leaves the domain " +
             IntervalText(basis.lower(), basis.upper()));
}

std::vector<double> LackingKnots(const SplineBasis& basis,
                                 std::vector<double> wanted,
                                 double length,
                                 bool round) {
  const double period = basis.upper() - basis.lower();
  std::vector<double> lacking;
  for (double value : wanted) {
    if (round) {
      while (value < basis.lower()) value += period;
      while (value >= basis.upper()) value -= period;
    }
    if (value < basis.lower() || value > basis.upper()) continue;
    const bool there = std::any_of(basis.knots().begin(), basis.knots().end(), [&](double knot) {
      return std::abs(knot - value) <= kSame * length;
    });
    if (!there) lacking.push_back(value);
  }
  std::sort(lacking.begin(), lacking.end());
  lacking.erase(std::unique(lacking.begin(), lacking.end()), lacking.end());
  return lacking;
}

std::vector<double> EvenPlaces(const ParameterRange& range, int spans) {
  std::vector<double> places = {range.from, range.to};
  for (int k = 1; k < spans; ++k)
    places.push_back(range.from + (range.to - range.from) * k / spans);
  return places;
}

std::vector<double> SharesInside(const SplineBasis& basis, const ParameterRange& range) {
  const double length = range.to - range.from, slack = kSame * length;
  const auto count = static_cast<size_t>(DistinctPoints(basis));
  std::vector<double> shares(count, -1);
  std::vector<bool> leaves(count, false);
  for (int i = 0; i < basis.size(); ++i) {
    const size_t k = static_cast<size_t>(i) % count;
    const auto at = static_cast<size_t>(i);
    const double first = std::max(basis.knots()[at], basis.lower());
    const double last =
        std::min(basis.knots()[at + static_cast<size_t>(basis.degree()) + 1], basis.upper());
    if (!(first < last)) continue;  // acts outside the domain only
    if (first < range.from - slack || last > range.to + slack) {
      leaves[k] = true;
    } else {
      shares[k] = std::clamp((basis.Greville(i) - range.from) / length, 0.0, 1.0);
    }
  }
  for (size_t k = 0; k < count; ++k) {
    if (leaves[k]) shares[k] = -1;
  }
  return shares;
}

std::vector<bool> ActingInside(const SplineBasis& basis, const ParameterRange& range) {
  const double slack = kSame * (range.to - range.from);
  const auto count = static_cast<size_t>(DistinctPoints(basis));
  std::vector<bool> acting(count, false);
  for (int i = 0; i < basis.size(); ++i) {
    const auto at = static_cast<size_t>(i);
    const double first = basis.knots()[at],
                 last = basis.knots()[at + static_cast<size_t>(basis.degree()) + 1];
    if (first < range.to - slack && last > range.from + slack) acting[at % count] = true;
  }
  return acting;
}

}  // namespace batten::internal
