// SPDX-License-Identifier: MIT
#include "fitting/curve/curve_ends.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace batten::internal {
namespace {

constexpr double kShareOfFarthest = 0.7;
constexpr double kLongest = 0.25;  // share of the end span by which an end may move at most

// The distance, in parameters, by which the end at `u` moves (direction −1 or 1 out of the domain).
double Move(const CorrectedFit& fit, double u, double direction, double noise, double spacing) {
  const SplineBasis& basis = fit.problem.basis_u();
  const int span = basis.Span(u), p = basis.degree();
  std::vector<double> values(static_cast<size_t>(2 * (p + 1)));
  basis.Derivatives(span, u, 1, values.data());
  const auto net = fit.solution.coefficients.middleCols(span - p, p + 1);
  const Eigen::Map<const Eigen::VectorXd> N(values.data(), p + 1), D(values.data() + p + 1, p + 1);
  const Eigen::VectorXd end = net * N, derivative = net * D;
  const double speed = derivative.norm();
  if (!(speed > 0)) return 0;
  const Eigen::VectorXd out = direction * derivative / speed;
  double farthest = 0;
  int count = 0;
  for (Eigen::Index k = 0; k < fit.problem.size(); ++k) {
    if (fit.problem.data().parameters(0, k) != u) continue;
    if (fit.problem.data().weights.size() > 0 && fit.problem.data().weights[k] == 0) continue;
    farthest = std::max(farthest, out.dot(fit.problem.data().values.col(k) - end));
    ++count;
  }
  if (count == 0) return 0;
  const double by_noise = kShareOfFarthest * noise * std::sqrt(2 * std::log(std::max(2, count)));
  return std::max(0.0, farthest - by_noise + spacing) / speed;
}

}  // namespace

SpanLayout WithLooseEnds(const SpanLayout& layout,
                         const CorrectedFit& fit,
                         double noise,
                         double spacing) {
  const std::vector<double>& breaks = layout.breaks();
  const size_t last = breaks.size() - 1;
  const auto within = [](double move, double span) { return std::min(move, kLongest * span); };
  const double lower = Move(fit, breaks.front(), -1, noise, spacing),
               upper = Move(fit, breaks.back(), 1, noise, spacing);
  return layout.Stretched(breaks.front() - within(lower, breaks[1] - breaks[0]),
                          breaks.back() + within(upper, breaks[last] - breaks[last - 1]));
}

}  // namespace batten::internal
