// SPDX-License-Identifier: MIT
#include "fitting/knots/data_knots.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "batten/geometry/knot_vectors.h"

namespace batten::internal {
namespace {

void CheckAround(int degree, std::span<const double> t) {
  const auto reject = [](const std::string& rule) {
    throw std::invalid_argument("KnotsAround: " + rule);
  };
  if (degree < 1 || degree > kMaxDegree) {
    reject("degree = " + std::to_string(degree) + " is not between 1 and " +
           std::to_string(kMaxDegree));
  }
  if (t.size() < 2) reject("there are no parameters");
  for (size_t k = 0; k < t.size(); ++k) {
    if (!std::isfinite(t[k])) reject("parameter " + std::to_string(k) + " is not finite");
    if (k > 0 && t[k] < t[k - 1]) reject("parameter " + std::to_string(k) + " decreases");
  }
  if (!(t.back() > t.front())) reject("all parameters are equal");
}

// Means of `count` parameters in a row, going round, the first one the last that is not above
// `t.front()`; one period of them and the first again.
std::vector<double> MeansAround(int count, std::span<const double> t) {
  const auto m = static_cast<int>(t.size()) - 1;
  const double period = t.back() - t.front();
  const auto at = [&](int k) {
    const int turns = k >= 0 ? k / m : -((m - 1 - k) / m);
    return t[static_cast<size_t>(k - turns * m)] - t.front() + turns * period;
  };
  const auto mean = [&](int k) {  // of those from k on
    double sum = 0;
    for (int i = k; i < k + count; ++i) sum += at(i) - at(k);
    return at(k) + sum / count;
  };
  int start = -(count - 1) / 2;
  while (mean(start) > 0) --start;
  while (mean(start + 1) <= 0) ++start;
  std::vector<double> means;
  for (int k = start; k < start + m; ++k) means.push_back(mean(k));
  means.push_back(means.front() + period);
  // Roundings may leave equal neighbours out of order.
  for (int k = 1; k <= m; ++k) means[k] = std::max(means[k], means[k - 1]);
  return means;
}

}  // namespace

ClosedKnots KnotsAround(int degree, std::span<const double> t) {
  CheckAround(degree, t);
  const auto m = static_cast<Eigen::Index>(t.size()) - 1;
  const Eigen::VectorXd given = Eigen::Map<const Eigen::VectorXd>(t.data(), m);
  const bool simple = std::adjacent_find(t.begin(), t.end()) == t.end();
  if (degree % 2 == 1 && simple) return {PeriodicKnots(degree, t), given};
  const double first = t.front(), last = t.back();
  std::vector<double> breaks = MeansAround(degree, t);
  const double shift = -breaks.front();
  for (double& u : breaks) u = (u + shift) + first;
  breaks.back() = last;
  Eigen::VectorXd parameters = given.array() + shift;
  for (double& u : parameters) u = u < last ? u : std::max(first, u - (last - first));
  return {PeriodicKnots(degree, breaks), std::move(parameters)};
}

std::optional<int> FirstUnsupported(const SplineBasis& basis, std::span<const double> t) {
  const std::vector<double>& knots = basis.knots();
  const int p = basis.degree();
  size_t next = 0;
  for (int i = 0; i < basis.size(); ++i) {
    const double low = knots[i], high = knots[i + p + 1];
    // At a clamped end the functions and their derivatives reach the end itself.
    while (next < t.size() && !(t[next] > low || (t[next] == low && low == basis.lower()))) ++next;
    if (next == t.size() || !(t[next] < high || (t[next] == high && high == basis.upper()))) {
      return i;
    }
    ++next;
  }
  return std::nullopt;
}

}  // namespace batten::internal
