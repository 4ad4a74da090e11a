// SPDX-License-Identifier: MIT
#include "fitting/constraints/local_projection.h"

#include <cmath>
#include <numbers>

#include "geometry/numeric/dense_solvers.h"

namespace batten::internal {
namespace {

// The longest span of the domain on which a function acts, as an index into `spans`.
size_t LongestSpan(const SplineBasis& basis, const std::vector<int>& spans, int i) {
  size_t best = 0;
  double longest = -1;
  for (size_t s = 0; s < spans.size(); ++s) {
    const double length = basis.knots()[spans[s] + 1] - basis.knots()[spans[s]];
    if (spans[s] < i || spans[s] > i + basis.degree() || length <= longest) continue;
    longest = length;
    best = s;
  }
  return best;
}

}  // namespace

double EndLength(const SplineBasis& basis, bool upper) {
  const int p = basis.degree(), n = basis.size();
  return (upper ? basis.knots()[n + p - 1] - basis.knots()[n - 1]
                : basis.knots()[p + 1] - basis.knots()[1]) /
         p;
}

LocalProjection ProjectionOnto(const SplineBasis& basis) {
  const int p = basis.degree();
  const std::vector<int> spans = basis.Spans();
  const auto count = static_cast<Eigen::Index>(spans.size()) * (p + 1);
  LocalProjection projection;
  projection.places.resize(count);
  projection.spans.resize(static_cast<size_t>(count));
  std::vector<Eigen::MatrixXd> coefficients(spans.size());  // of values at a span's places
  for (size_t s = 0; s < spans.size(); ++s) {
    const double a = basis.knots()[spans[s]], b = basis.knots()[spans[s] + 1];
    Eigen::MatrixXd functions(p + 1, p + 1);
    std::vector<double> values(static_cast<size_t>(p) + 1);
    for (int k = 0; k <= p; ++k) {
      const double t = (1 - std::cos(std::numbers::pi * k / p)) / 2;
      const double u = k == 0 ? a : k == p ? b : a + t * (b - a);
      const Eigen::Index place = static_cast<Eigen::Index>(s) * (p + 1) + k;
      projection.places[place] = u;
      projection.spans[static_cast<size_t>(place)] = spans[s];
      basis.Values(spans[s], u, values.data());
      for (int r = 0; r <= p; ++r) functions(k, r) = values[static_cast<size_t>(r)];
    }
    coefficients[s] = InverseOf(functions);
  }
  std::vector<Eigen::Triplet<double>> entries;
  const int last = basis.size() - 1, places = static_cast<int>(count);
  for (int i = 0; i <= last; ++i) {
    const bool by_slope = basis.clamped() && p > 1 && (i == 1 || i == last - 1) && last > 1;
    if (by_slope) {
      const bool upper = i != 1;
      entries.emplace_back(i, upper ? places - 1 : 0, 1.0);
      entries.emplace_back(
          i, places + (upper ? 1 : 0), upper ? -EndLength(basis, true) : EndLength(basis, false));
      continue;
    }
    const size_t s = LongestSpan(basis, spans, i);
    for (int k = 0; k <= p; ++k) {
      entries.emplace_back(
          i, static_cast<int>(s) * (p + 1) + k, coefficients[s](i - spans[s] + p, k));
    }
  }
  projection.matrix.resize(basis.size(), count + 2);
  projection.matrix.setFromTriplets(entries.begin(), entries.end());
  return projection;
}

}  // namespace batten::internal
