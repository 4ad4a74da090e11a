// SPDX-License-Identifier: MIT
#include "geometry/construction/monotone_map.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "batten/geometry/knot_vectors.h"
#include "geometry/construction/spline_interpolation.h"

namespace batten::internal {
namespace {

// Slopes of chords, one for each interval.
std::vector<double> ChordSlopes(const std::vector<double>& places,
                                const std::vector<double>& values) {
  std::vector<double> slopes;
  for (std::size_t k = 0; k + 1 < places.size(); ++k) {
    slopes.push_back((values[k + 1] - values[k]) / (places[k + 1] - places[k]));
  }
  return slopes;
}

// The harmonic mean of the chords' slopes beside each place; an end has that of its chord, where
// cyclic the mean across the seam.
std::vector<double> HarmonicSlopes(const std::vector<double>& chords, bool cyclic) {
  const auto mean = [](double a, double b) { return 2 * a * b / (a + b); };
  std::vector<double> slopes = {cyclic ? mean(chords.back(), chords.front()) : chords.front()};
  for (std::size_t k = 1; k < chords.size(); ++k) slopes.push_back(mean(chords[k - 1], chords[k]));
  slopes.push_back(cyclic ? slopes.front() : chords.back());
  return slopes;
}

// Slopes of the C^2 spline: of f(s) − s over periodic knots where cyclic, else with the slopes
// `ends` has at both ends.
std::vector<double> SmoothSlopes(const std::vector<double>& places,
                                 const std::vector<double>& values,
                                 const std::vector<double>& ends,
                                 bool cyclic) {
  constexpr int kDegree = 3;
  const SplineBasis basis =
      cyclic ? PeriodicKnots(kDegree, places) : SplineBasis::Clamped(kDegree, places);
  std::vector<SplineDatum> data;
  std::vector<double> right;
  const auto add = [&](double at, int order, double value) {
    data.push_back({at, order});
    right.push_back(value);
  };
  if (!cyclic) add(places.front(), 1, ends.front() - 1);
  for (std::size_t k = 0; k + (cyclic ? 1 : 0) < places.size(); ++k) {
    add(places[k], 0, values[k] - places[k]);
  }
  if (!cyclic) add(places.back(), 1, ends.back() - 1);
  const Eigen::RowVectorXd coefficients = Interpolated(
      basis,
      data,
      Eigen::Map<Eigen::RowVectorXd>(right.data(), static_cast<Eigen::Index>(right.size())));
  std::vector<double> slopes;
  double values_here[2 * (kDegree + 1)];
  for (const double at : places) {
    const int span = basis.Span(at);
    basis.Derivatives(span, at, 1, values_here);
    slopes.push_back(1 + coefficients.segment<kDegree + 1>(span - kDegree)
                             .dot(Eigen::Map<Eigen::RowVector4d>(values_here + kDegree + 1)));
  }
  return slopes;
}

// Sufficient: no slope at an end of an interval is negative or above three times its chord's.
bool Increases(const std::vector<double>& slopes, const std::vector<double>& chords) {
  for (std::size_t k = 0; k < chords.size(); ++k) {
    const double most = 3 * chords[k];
    if (!(slopes[k] > 0 && slopes[k] <= most && slopes[k + 1] > 0 && slopes[k + 1] <= most)) {
      return false;
    }
  }
  return true;
}

}  // namespace

MonotoneMap::MonotoneMap(std::vector<double> places, std::vector<double> values, bool cyclic)
    : places_(std::move(places)), values_(std::move(values)), continuity_(2) {
  const std::vector<double> chords = ChordSlopes(places_, values_);
  const std::vector<double> harmonic = HarmonicSlopes(chords, cyclic);
  slopes_ = SmoothSlopes(places_, values_, harmonic, cyclic);
  if (Increases(slopes_, chords)) return;
  slopes_ = harmonic;
  continuity_ = 1;
}

Retracing MonotoneMap::At(double s, Side side) const {
  const auto above = side == Side::kBelow ? std::ranges::lower_bound(places_, s)
                                          : std::ranges::upper_bound(places_, s);
  const std::ptrdiff_t last = static_cast<std::ptrdiff_t>(places_.size()) - 2;
  const std::ptrdiff_t k = std::clamp<std::ptrdiff_t>(above - places_.begin() - 1, 0, last);
  const double h = places_[k + 1] - places_[k], t = (s - places_[k]) / h, r = 1 - t;
  const double rise = values_[k + 1] - values_[k];
  const double value =
      values_[k] + rise * t * t * (3 - 2 * t) + h * t * r * (slopes_[k] * r - slopes_[k + 1] * t);
  const double pace =
      6 * t * r * rise / h + slopes_[k] * r * (1 - 3 * t) + slopes_[k + 1] * t * (3 * t - 2);
  return {std::clamp(value, 0.0, 1.0), pace};
}

double MonotoneMap::InverseAt(double value) const {
  double low = 0, high = 1;
  constexpr int kHalvings = 60;
  for (int k = 0; k < kHalvings; ++k) {
    const double middle = (low + high) / 2;
    (At(middle, Side::kAbove).at < value ? low : high) = middle;
  }
  return (low + high) / 2;
}

}  // namespace batten::internal
