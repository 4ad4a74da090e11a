// SPDX-License-Identifier: MIT
#include "batten/geometry/spline_basis.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace batten {
namespace {

[[noreturn]] void Reject(const std::string& rule) {
  throw std::invalid_argument("SplineBasis: " + rule);
}

void CheckDegree(int degree) {
  if (degree < 1 || degree > kMaxDegree) {
    Reject("degree " + std::to_string(degree) + " is not in [1, " + std::to_string(kMaxDegree) +
           "]");
  }
}

}  // namespace

SplineBasis::SplineBasis(int degree, std::vector<double> knots)
    : degree_(degree), knots_(std::move(knots)) {
  CheckDegree(degree_);
  const int count = static_cast<int>(knots_.size());
  if (count < 2 * (degree_ + 1)) {
    Reject(std::to_string(count) + " knots are too few for degree " + std::to_string(degree_) +
           ": at least " + std::to_string(2 * (degree_ + 1)) + " are needed");
  }
  for (int i = 0; i < count; ++i) {
    if (!std::isfinite(knots_[i])) Reject("knot " + std::to_string(i) + " is not finite");
    if (i > 0 && knots_[i] < knots_[i - 1]) {
      Reject("knot " + std::to_string(i) + " decreases (" + std::to_string(knots_[i - 1]) + " to " +
             std::to_string(knots_[i]) + ")");
    }
  }
  if (!(lower() < upper())) Reject("the domain is empty");
  for (int i = 0; i < count;) {
    int j = i;
    while (j < count && knots_[j] == knots_[i]) ++j;
    const bool interior = knots_[i] > lower() && knots_[i] < upper();
    const int limit = interior ? degree_ : degree_ + 1;
    if (j - i > limit) {
      Reject("knot " + std::to_string(knots_[i]) + " is repeated " + std::to_string(j - i) +
             " times; at most " + std::to_string(limit) + " are allowed for degree " +
             std::to_string(degree_));
    }
    i = j;
  }
}

SplineBasis SplineBasis::Periodic(int degree, std::vector<double> knots) {
  SplineBasis basis(degree, std::move(knots));
  const std::vector<double>& U = basis.knots_;
  const double period = basis.upper() - basis.lower();
  constexpr double kRepeats = 1e-12;
  const double allowed = kRepeats * std::max({period, std::abs(U.front()), std::abs(U.back())});
  const size_t distinct = static_cast<size_t>(basis.size() - degree);
  for (size_t i = 0; i + distinct < U.size(); ++i) {
    if (std::abs(U[i + distinct] - U[i] - period) <= allowed) continue;
    Reject("knots " + std::to_string(i) + " and " + std::to_string(i + distinct) +
           " of a periodic "
           "basis are not one period " +
           std::to_string(period) + " apart (" + std::to_string(U[i]) + ", " +
           std::to_string(U[i + distinct]) + ")");
  }
  basis.periodic_ = true;
  return basis;
}

SplineBasis SplineBasis::Clamped(int degree, std::span<const double> breaks) {
  CheckDegree(degree);
  if (breaks.size() < 2) Reject("at least two breaks are needed");
  std::vector<double> knots(degree + 1, breaks.front());
  knots.insert(knots.end(), breaks.begin() + 1, breaks.end() - 1);
  knots.insert(knots.end(), degree + 1, breaks.back());
  return SplineBasis(degree, std::move(knots));
}

SplineBasis SplineBasis::Uniform(int degree, int size, double lower, double upper) {
  CheckDegree(degree);
  if (size <= degree) {
    Reject(std::to_string(size) + " functions are too few for degree " + std::to_string(degree));
  }
  const int cells = size - degree;
  std::vector<double> breaks(cells + 1);
  for (int i = 0; i <= cells; ++i) breaks[i] = lower + (upper - lower) * i / cells;
  breaks.back() = upper;
  return Clamped(degree, breaks);
}

int SplineBasis::Span(double u) const {
  const int n = size();
  if (u >= knots_[n]) {
    const auto end = std::lower_bound(knots_.begin() + degree_, knots_.begin() + n, knots_[n]);
    return static_cast<int>(end - knots_.begin()) - 1;
  }
  if (!(u > knots_[degree_])) u = knots_[degree_];
  const auto next = std::upper_bound(knots_.begin() + degree_, knots_.begin() + n + 1, u);
  return static_cast<int>(next - knots_.begin()) - 1;
}

std::vector<int> SplineBasis::Spans() const {
  std::vector<int> spans;
  for (int i = degree_; i < size(); ++i) {
    if (knots_[i] < knots_[i + 1]) spans.push_back(i);
  }
  return spans;
}

// Triangular table of the Cox–de Boor recursion, kept one row at a time. [Piegl & Tiller 1997,
// A2.2]
void SplineBasis::Values(int span, double u, double* N) const {
  const double* U = knots_.data() + span;
  double left[kMaxDegree + 1], right[kMaxDegree + 1];
  N[0] = 1;
  for (int j = 1; j <= degree_; ++j) {
    left[j] = u - U[1 - j];
    right[j] = U[j] - u;
    double saved = 0;
    for (int r = 0; r < j; ++r) {
      const double term = N[r] / (right[r + 1] + left[j - r]);
      N[r] = saved + right[r + 1] * term;
      saved = left[j - r] * term;
    }
    N[j] = saved;
  }
}

// The derivative of a B-spline function is a difference of two functions of one degree less, scaled
// by p over the length of their supports; applied k times to the stored table. [A2.3, eq. 2.9]
void SplineBasis::Derivatives(int span, double u, int order, double* values) const {
  const int p = degree_;
  const double* U = knots_.data() + span;
  double left[kMaxDegree + 1], right[kMaxDegree + 1];
  double table[kMaxDegree + 1][kMaxDegree + 1];  // row j: functions of degree j (upper part) …
  double width[kMaxDegree + 1][kMaxDegree + 1];  // … and the knot differences they are divided by
  table[0][0] = 1;
  for (int j = 1; j <= p; ++j) {
    left[j] = u - U[1 - j];
    right[j] = U[j] - u;
    double saved = 0;
    for (int r = 0; r < j; ++r) {
      width[j][r] = right[r + 1] + left[j - r];
      const double term = table[j - 1][r] / width[j][r];
      table[j][r] = saved + right[r + 1] * term;
      saved = left[j - r] * term;
    }
    table[j][j] = saved;
  }
  for (int r = 0; r <= p; ++r) values[r] = table[p][r];
  const int top = std::min(order, p);
  // From the functions of degree p-k, k differences lead up to degree p; the row is padded by
  // zeros.
  for (int k = 1; k <= top; ++k) {
    double row[kMaxDegree + 1];
    for (int r = 0; r <= p - k; ++r) row[r] = table[p - k][r];
    for (int j = p - k + 1; j <= p; ++j) {
      double previous = 0;
      for (int r = 0; r < j; ++r) {
        const double term = row[r] / width[j][r];
        row[r] = j * (previous - term);
        previous = term;
      }
      row[j] = j * previous;
    }
    for (int r = 0; r <= p; ++r) values[k * (p + 1) + r] = row[r];
  }
  for (int k = top + 1; k <= order; ++k) std::fill_n(values + k * (p + 1), p + 1, 0.0);
}

double SplineBasis::Greville(int i) const {
  double sum = 0;
  for (int j = 1; j <= degree_; ++j) sum += knots_[i + j];
  return sum / degree_;
}

double SplineBasis::Clamp(double u) const {
  if (u >= lower() && u <= upper()) return u;
  if (!periodic_ || !std::isfinite(u)) return u < lower() ? lower() : upper();
  const double period = upper() - lower();
  const double wrapped = u - period * std::floor((u - lower()) / period);
  return wrapped >= lower() && wrapped < upper() ? wrapped : lower();
}

int SplineBasis::Multiplicity(double knot) const {
  return static_cast<int>(std::count(knots_.begin(), knots_.end(), knot));
}

}  // namespace batten
