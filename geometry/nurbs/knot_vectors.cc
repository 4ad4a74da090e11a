// SPDX-License-Identifier: MIT
#include "batten/geometry/knot_vectors.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <stdexcept>
#include <string>
#include <utility>

#include "geometry/numeric/number_text.h"
#include "geometry/numeric/reject.h"

namespace batten {
using namespace internal;
namespace {

void CheckDomain(const std::string& function, double lower, double upper) {
  if (!(lower < upper) || !std::isfinite(upper - lower)) {
    Reject(function, "the domain " + IntervalText(lower, upper) + " is empty or not finite");
  }
}

void CheckSize(const std::string& function, int degree, int size) {
  if (degree < 1 || degree > kMaxDegree) {
    Reject(
        function,
        "degree " + std::to_string(degree) + " is not in [1, " + std::to_string(kMaxDegree) + "]");
  }
  if (size <= degree) {
    Reject(function,
           std::to_string(size) + " functions are too few for degree " + std::to_string(degree) +
               ": more than the degree are needed");
  }
}

void CheckParameters(const std::string& function, std::span<const double> t) {
  for (size_t k = 0; k < t.size(); ++k) {
    if (!std::isfinite(t[k])) Reject(function, "parameter " + std::to_string(k) + " is not finite");
    if (k > 0 && t[k] < t[k - 1]) {
      Reject(function,
             "parameter " + std::to_string(k) + " decreases (" + NumberText(t[k - 1]) + " to " +
                 NumberText(t[k]) + ")");
    }
  }
  if (t.empty() || t.front() == t.back()) Reject(function, "all parameters are the same");
}

// Clamped at lower and upper, with these inner knots.
SplineBasis ClampedBasis(int degree, double lower, std::vector<double> inner, double upper) {
  inner.insert(inner.begin(), degree + 1, lower);
  inner.insert(inner.end(), degree + 1, upper);
  return SplineBasis(degree, std::move(inner));
}

double Between(double lower, double upper, double part) { return lower + (upper - lower) * part; }

}  // namespace

SplineBasis UniformKnots(int degree, int size, double lower, double upper) {
  CheckSize("UniformKnots", degree, size);
  CheckDomain("UniformKnots", lower, upper);
  const int spans = size - degree;
  std::vector<double> knots;
  for (int i = -degree; i <= size; ++i) {
    knots.push_back(i == spans ? upper : Between(lower, upper, double(i) / spans));
  }
  return SplineBasis(degree, std::move(knots));
}

SplineBasis QuasiUniformKnots(int degree, int size, double lower, double upper) {
  CheckSize("QuasiUniformKnots", degree, size);
  CheckDomain("QuasiUniformKnots", lower, upper);
  return SplineBasis::Uniform(degree, size, lower, upper);
}

SplineBasis PeriodicKnots(int degree, std::span<const double> breaks) {
  CheckSize("PeriodicKnots", degree, degree + 1);
  if (breaks.size() < 2) Reject("PeriodicKnots", "at least two breaks are needed");
  CheckDomain("PeriodicKnots", breaks.front(), breaks.back());
  const int m = static_cast<int>(breaks.size()) - 1;
  const double period = breaks.back() - breaks.front();
  std::vector<double> knots;
  for (int i = -degree; i <= m + degree; ++i) {
    const int turns = i >= 0 ? i / m : -((m - 1 - i) / m);
    const double base = breaks[i - turns * m];
    // Outside, counted from the nearer end of the domain: ends repeated there are met exactly.
    if (turns == 0) {
      knots.push_back(base);
    } else if (turns < 0) {
      knots.push_back(breaks[0] - ((breaks[m] - base) + (-turns - 1) * period));
    } else {
      knots.push_back(breaks[m] + ((base - breaks[0]) + (turns - 1) * period));
    }
  }
  return SplineBasis::Periodic(degree, std::move(knots));
}

SplineBasis PeriodicUniformKnots(int degree, int distinct, double lower, double upper) {
  if (distinct < 1) {
    Reject("PeriodicUniformKnots", std::to_string(distinct) + " spans are not at least one");
  }
  CheckDomain("PeriodicUniformKnots", lower, upper);
  std::vector<double> breaks;
  for (int i = 0; i < distinct; ++i) breaks.push_back(Between(lower, upper, double(i) / distinct));
  breaks.push_back(upper);
  return PeriodicKnots(degree, breaks);
}

SplineBasis AveragedKnots(int degree, std::span<const double> t) {
  const int n = static_cast<int>(t.size());
  CheckSize("AveragedKnots", degree, n);
  CheckParameters("AveragedKnots", t);
  std::vector<double> inner;
  for (int j = 1; j < n - degree; ++j) {
    // From the first of them, so that equal parameters give exactly that knot.
    double sum = 0;
    for (int i = j; i < j + degree; ++i) sum += t[i] - t[j];
    inner.push_back(std::min(t[j] + sum / degree, t[j + degree - 1]));
  }
  return ClampedBasis(degree, t.front(), std::move(inner), t.back());
}

SplineBasis LeastSquaresKnots(int degree, int size, std::span<const double> t) {
  CheckSize("LeastSquaresKnots", degree, size);
  CheckParameters("LeastSquaresKnots", t);
  const int count = static_cast<int>(t.size()), spans = size - degree;
  if (size > count) {
    Reject("LeastSquaresKnots",
           std::to_string(size) + " functions are more than the " + std::to_string(count) +
               " parameters");
  }
  std::vector<double> inner;
  for (int j = 1; j < spans; ++j) {
    // j·count/spans in whole and fractional part, without rounding the whole one.
    const auto product = std::int64_t{j} * count;
    const auto i = static_cast<size_t>(product / spans);
    const double part = static_cast<double>(product % spans) / spans;
    inner.push_back(std::clamp(Between(t[i - 1], t[i], part), t[i - 1], t[i]));
  }
  return ClampedBasis(degree, t.front(), std::move(inner), t.back());
}

SplineBasis DensityKnots(int degree, int size, std::span<const double> t) {
  CheckSize("DensityKnots", degree, size);
  CheckParameters("DensityKnots", t);
  // Distinct parameters, and how many parameters there are up to each.
  std::vector<double> values;
  std::vector<std::int64_t> up_to;
  for (size_t k = 0; k < t.size(); ++k) {
    if (k + 1 < t.size() && t[k + 1] == t[k]) continue;
    values.push_back(t[k]);
    up_to.push_back(static_cast<std::int64_t>(k) + 1);
  }
  const int distinct = static_cast<int>(values.size()), spans = size - degree;
  if (size > distinct) {
    Reject("DensityKnots",
           std::to_string(size) + " functions are more than the " + std::to_string(distinct) +
               " different parameters");
  }
  std::vector<double> inner;
  int last = 0;  // distinct parameters below the latest knot
  for (int j = 1; j < spans; ++j) {
    // The gap between values[k-1] and values[k] that leaves nearest to j/spans of the parameters
    // below it, one value for this span and one for each span to come.
    const double wanted = static_cast<double>(j) * static_cast<double>(t.size()) / spans;
    const int least = last + 1, most = distinct - (spans - j);
    int k = least;
    while (k < most && static_cast<double>(up_to[k]) <= wanted) ++k;
    if (k < most &&
        static_cast<double>(up_to[k]) - wanted < wanted - static_cast<double>(up_to[k - 1]))
      ++k;
    inner.push_back(values[k - 1] + (values[k] - values[k - 1]) / 2);
    last = k;
  }
  return ClampedBasis(degree, t.front(), std::move(inner), t.back());
}

SplineBasis RiesenfeldKnots(int degree, const Eigen::Ref<const Eigen::MatrixXd>& points) {
  const int n = static_cast<int>(points.cols());
  CheckSize("RiesenfeldKnots", degree, n);
  if (!points.allFinite()) Reject("RiesenfeldKnots", "a control point is not finite");
  Eigen::VectorXd along = Eigen::VectorXd::Zero(n);  // length of the polygon up to each vertex
  for (int i = 1; i < n; ++i) {
    along[i] = along[i - 1] + (points.col(i) - points.col(i - 1)).stableNorm();
  }
  const double length = along[n - 1];
  if (!(length > 0) || !std::isfinite(length)) {
    Reject("RiesenfeldKnots", "the polygon has length " + NumberText(length));
  }
  std::vector<double> inner;
  const bool odd = degree % 2 == 1;
  for (int i = 1; i < n - degree; ++i) {
    const int vertex = odd ? (degree - 1) / 2 + i : degree / 2 + i;  // or the end of the edge
    const double place =
        odd ? along[vertex] : along[vertex - 1] + (along[vertex] - along[vertex - 1]) / 2;
    inner.push_back(place / length);
  }
  for (const auto& [knot, multiplicity] : DistinctKnots(inner)) {
    if (knot > 0 && knot < 1 && multiplicity <= degree) continue;
    Reject("RiesenfeldKnots",
           "coincident control points would make the inner knot " + NumberText(knot) +
               " of multiplicity " + std::to_string(multiplicity) + "; inside ]0, 1[ at most the " +
               "degree " + std::to_string(degree) + " is allowed");
  }
  return ClampedBasis(degree, 0, std::move(inner), 1);
}

namespace {

// Every knot changed, in order, the result in increasing order and of the same kind.
template <typename Change>
SplineBasis Changed(const SplineBasis& basis, const Change& change, bool reversed) {
  std::vector<double> knots = basis.knots();
  if (reversed) std::reverse(knots.begin(), knots.end());
  for (double& knot : knots) knot = change(knot);
  // Roundings in different places may leave neighbours a unit in the last place out of order.
  for (size_t i = 1; i < knots.size(); ++i) knots[i] = std::max(knots[i], knots[i - 1]);
  return basis.periodic() ? SplineBasis::Periodic(basis.degree(), std::move(knots))
                          : SplineBasis(basis.degree(), std::move(knots));
}

}  // namespace

SplineBasis Scaled(const SplineBasis& basis, double lower, double upper) {
  CheckDomain("Scaled", lower, upper);
  const double a = basis.lower(), b = basis.upper(), factor = (upper - lower) / (b - a);
  const auto change = [&](double u) {
    return u - a <= b - u ? lower + (u - a) * factor : upper - (b - u) * factor;
  };
  return Changed(basis, change, false);
}

SplineBasis Reversed(const SplineBasis& basis) {
  const double a = basis.lower(), b = basis.upper();
  const auto change = [&](double u) { return u - a <= b - u ? b - (u - a) : a + (b - u); };
  return Changed(basis, change, true);
}

std::vector<KnotMultiplicity> DistinctKnots(std::span<const double> knots, double tolerance) {
  if (!(tolerance >= 0)) {
    Reject("DistinctKnots", "tolerance = " + NumberText(tolerance) + " is negative");
  }
  std::vector<KnotMultiplicity> distinct;
  for (const double knot : knots) {
    if (!distinct.empty() && knot - distinct.back().knot <= tolerance) {
      ++distinct.back().multiplicity;
    } else {
      distinct.push_back({knot, 1});
    }
  }
  return distinct;
}

std::vector<KnotMultiplicity> DomainKnots(const SplineBasis& basis) {
  std::vector<KnotMultiplicity> distinct = DistinctKnots(basis.knots());
  std::erase_if(distinct, [&](const KnotMultiplicity& k) {
    return k.knot < basis.lower() || k.knot > basis.upper();
  });
  return distinct;
}

bool SameKnots(const SplineBasis& a, const SplineBasis& b, double tolerance) {
  if (!(tolerance >= 0)) {
    Reject("SameKnots", "tolerance = " + NumberText(tolerance) + " is negative");
  }
  if (a.degree() != b.degree() || a.periodic() != b.periodic()) return false;
  return std::equal(a.knots().begin(),
                    a.knots().end(),
                    b.knots().begin(),
                    b.knots().end(),
                    [&](double x, double y) { return std::abs(x - y) <= tolerance; });
}

std::vector<double> MissingKnots(const SplineBasis& basis, const SplineBasis& other) {
  std::vector<double> missing;
  std::set_difference(other.knots().begin(),
                      other.knots().end(),
                      basis.knots().begin(),
                      basis.knots().end(),
                      std::back_inserter(missing));
  std::erase_if(missing, [&](double u) { return !(u > basis.lower() && u < basis.upper()); });
  return missing;
}

}  // namespace batten
