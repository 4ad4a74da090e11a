// SPDX-License-Identifier: MIT
#include "batten/geometry/spline_basis.h"
#include "geometry/numeric/reject.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <type_traits>

namespace batten {
using namespace internal;
namespace {

// The shortest text that reads back as the same number.
std::string Text(double number) {
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, number).ptr;
  return std::string(text, end);
}

void CheckDegree(int degree) {
  if (degree < 1 || degree > kMaxDegree) {
    Reject(
        "SplineBasis",
        "degree " + std::to_string(degree) + " is not in [1, " + std::to_string(kMaxDegree) + "]");
  }
}

// Finite, non-decreasing, and with differences that can be divided by.
void CheckKnots(const std::vector<double>& knots) {
  for (size_t i = 0; i < knots.size(); ++i) {
    if (!std::isfinite(knots[i]))
      Reject("SplineBasis", "knot " + std::to_string(i) + " is not finite");
    if (i == 0) continue;
    const double gap = knots[i] - knots[i - 1];
    if (gap < 0) {
      Reject("SplineBasis",
             "knot " + std::to_string(i) + " decreases (" + Text(knots[i - 1]) + " to " +
                 Text(knots[i]) + ")");
    }
    if (gap > 0 && gap < std::numeric_limits<double>::min()) {
      Reject("SplineBasis",
             "knots " + std::to_string(i - 1) + " and " + std::to_string(i) +
                 " differ by less than the smallest normal double (" + Text(knots[i - 1]) + ", " +
                 Text(knots[i]) + ")");
    }
  }
  if (!std::isfinite(knots.back() - knots.front())) {
    Reject("SplineBasis",
           "the knots are farther apart than the largest double (" + Text(knots.front()) + " to " +
               Text(knots.back()) + ")");
  }
}

// Triangular table of the Cox–de Boor recursion, kept one row at a time; U points to the span's
// lower knot. A number known when compiling, or a run-time one. [Piegl & Tiller 1997, A2.2]
template <typename Degree>
void ValuesKernel(Degree p, const double* U, double u, double* N) {
  N[0] = 1;
  for (int j = 1; j <= p; ++j) {
    double saved = 0;
    for (int r = 0; r < j; ++r) {
      const double term = N[r] * (1 / (U[r + 1] - U[r + 1 - j]));
      N[r] = saved + (U[r + 1] - u) * term;
      saved = (u - U[r + 1 - j]) * term;
    }
    N[j] = saved;
  }
}

// The derivative of a B-spline function is a difference of two functions of one degree less, scaled
// by p over the length of their supports; applied k times to the stored table. [A2.3, eq. 2.9]
template <typename Degree>
void DerivativesKernel(Degree p, const double* U, double u, int order, double* values) {
  double table[kMaxDegree + 1][kMaxDegree + 1];    // row j: functions of degree j, and …
  double inverse[kMaxDegree + 1][kMaxDegree + 1];  // … one over the lengths they are divided by
  table[0][0] = 1;
  for (int j = 1; j <= p; ++j) {
    double saved = 0;
    for (int r = 0; r < j; ++r) {
      inverse[j][r] = 1 / (U[r + 1] - U[r + 1 - j]);
      const double term = table[j - 1][r] * inverse[j][r];
      table[j][r] = saved + (U[r + 1] - u) * term;
      saved = (u - U[r + 1 - j]) * term;
    }
    table[j][j] = saved;
  }
  for (int r = 0; r <= p; ++r) values[r] = table[p][r];
  const int top = std::min<int>(order, p);
  // From the functions of degree p−k, k differences lead up to degree p; the row is padded by
  // zeros.
  for (int k = 1; k <= top; ++k) {
    double row[kMaxDegree + 1];
    for (int r = 0; r <= p - k; ++r) row[r] = table[p - k][r];
    for (int j = p - k + 1; j <= p; ++j) {
      double previous = 0;
      for (int r = 0; r < j; ++r) {
        const double term = row[r] * inverse[j][r];
        row[r] = j * (previous - term);
        previous = term;
      }
      row[j] = j * previous;
    }
    for (int r = 0; r <= p; ++r) values[k * (p + 1) + r] = row[r];
  }
  for (int k = top + 1; k <= order; ++k) std::fill_n(values + k * (p + 1), p + 1, 0.0);
}

// Calls kernel(degree), with a degree known when compiling for the usual ones: their loops unroll.
template <typename Kernel>
void ForDegree(int degree, const Kernel& kernel) {
  switch (degree) {
    case 1:
      return kernel(std::integral_constant<int, 1>());
    case 2:
      return kernel(std::integral_constant<int, 2>());
    case 3:
      return kernel(std::integral_constant<int, 3>());
    case 4:
      return kernel(std::integral_constant<int, 4>());
    case 5:
      return kernel(std::integral_constant<int, 5>());
    default:
      return kernel(degree);
  }
}

}  // namespace

SplineBasis::SplineBasis(int degree, std::vector<double> knots)
    : degree_(degree), knots_(std::move(knots)) {
  CheckDegree(degree_);
  const int count = static_cast<int>(knots_.size());
  if (count < 2 * (degree_ + 1)) {
    Reject("SplineBasis",
           std::to_string(count) + " knots are too few for degree " + std::to_string(degree_) +
               ": at least " + std::to_string(2 * (degree_ + 1)) + " are needed");
  }
  CheckKnots(knots_);
  if (!(lower() < upper())) Reject("SplineBasis", "the domain is empty");
  for (int i = 0; i < count;) {
    int j = i;
    while (j < count && knots_[j] == knots_[i]) ++j;
    const bool interior = knots_[i] > lower() && knots_[i] < upper();
    const int limit = interior ? degree_ : degree_ + 1;
    if (j - i > limit) {
      Reject("SplineBasis",
             "knot " + Text(knots_[i]) + " is repeated " + std::to_string(j - i) +
                 " times; at most " + std::to_string(limit) + " are allowed for degree " +
                 std::to_string(degree_));
    }
    i = j;
  }
  spans_per_length_ = (size() - degree_) / (upper() - lower());
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
    Reject("SplineBasis",
           "knots " + std::to_string(i) + " and " + std::to_string(i + distinct) +
               " of a periodic basis are not one period " + Text(period) + " apart (" + Text(U[i]) +
               ", " + Text(U[i + distinct]) + ")");
  }
  basis.periodic_ = true;
  return basis;
}

SplineBasis SplineBasis::Clamped(int degree, std::span<const double> breaks) {
  CheckDegree(degree);
  if (breaks.size() < 2) Reject("SplineBasis", "at least two breaks are needed");
  std::vector<double> knots(degree + 1, breaks.front());
  knots.insert(knots.end(), breaks.begin() + 1, breaks.end() - 1);
  knots.insert(knots.end(), degree + 1, breaks.back());
  return SplineBasis(degree, std::move(knots));
}

SplineBasis SplineBasis::Uniform(int degree, int size, double lower, double upper) {
  CheckDegree(degree);
  if (size <= degree) {
    Reject("SplineBasis",
           std::to_string(size) + " functions are too few for degree " + std::to_string(degree));
  }
  const int cells = size - degree;
  std::vector<double> breaks(cells + 1);
  for (int i = 0; i <= cells; ++i) breaks[i] = lower + (upper - lower) * i / cells;
  breaks.back() = upper;
  return Clamped(degree, breaks);
}

// Even knots would put u on span p + (u − u_p)·(n − p)/(u_n − u_p): looked at first, and next to
// it.
int SplineBasis::Span(double u) const {
  const double* U = knots_.data();
  const int p = degree_, n = size();
  if (u >= U[n]) {
    return static_cast<int>(std::lower_bound(U + p, U + n, U[n]) - U) - 1;
  }
  if (!(u > U[p])) {
    if (std::isnan(u)) throw std::invalid_argument("SplineBasis::Span: u is not a number");
    u = U[p];
  }
  const double even = (u - U[p]) * spans_per_length_;
  const int guess = p + (even < n - p - 1 ? static_cast<int>(even) : n - p - 1);
  if (U[guess] <= u) {
    if (u < U[guess + 1]) return guess;
    if (u < U[guess + 2]) return guess + 1;
  } else if (U[guess - 1] <= u) {
    return guess - 1;
  }
  int span = p;  // U[span] ≤ u < U[span + count]
  for (int count = n - p; count > 1;) {
    const int half = count / 2;
    span += U[span + half] <= u ? half : 0;
    count -= half;
  }
  return span;
}

std::vector<int> SplineBasis::Spans() const {
  std::vector<int> spans;
  for (int i = degree_; i < size(); ++i) {
    if (knots_[i] < knots_[i + 1]) spans.push_back(i);
  }
  return spans;
}

void SplineBasis::Values(int span, double u, double* values) const {
  ForDegree(degree_, [&](auto p) { ValuesKernel(p, knots_.data() + span, u, values); });
}

void SplineBasis::Derivatives(int span, double u, int order, double* values) const {
  ForDegree(degree_, [&](auto p) { DerivativesKernel(p, knots_.data() + span, u, order, values); });
}

double SplineBasis::Function(int i, double u) const { return FunctionDerivatives(i, u, 0)[0]; }

std::vector<double> SplineBasis::FunctionDerivatives(int i, double u, int order) const {
  const std::string where = "SplineBasis::FunctionDerivatives: ";
  if (i < 0 || i >= size()) {
    throw std::invalid_argument(where + "function " + std::to_string(i) + " is not in [0, " +
                                std::to_string(size() - 1) + "]");
  }
  if (order < 0) throw std::invalid_argument(where + "order is negative");
  u = Clamp(u);
  const int p = degree_, span = Span(u), top = std::min(order, p);
  std::vector<double> result(static_cast<size_t>(order) + 1, 0.0);
  if (i < span - p || i > span) return result;
  double all[(kMaxDegree + 1) * (kMaxDegree + 1)];
  Derivatives(span, u, top, all);
  for (int k = 0; k <= top; ++k) result[k] = all[k * (p + 1) + i - span + p];
  return result;
}

// Taken from the first of them: exact where they coincide, and free of overflow.
double SplineBasis::Greville(int i) const {
  const double first = knots_[i + 1];
  double sum = 0;
  for (int j = 2; j <= degree_; ++j) sum += knots_[i + j] - first;
  return first + sum / degree_;
}

double SplineBasis::Clamp(double u) const {
  if (u >= lower() && u <= upper()) return u;
  if (std::isnan(u)) throw std::invalid_argument("SplineBasis::Clamp: u is not a number");
  if (periodic_) return Wrap(u);
  return u < lower() ? lower() : upper();
}

// fmod is exact, so that even a far parameter loses nothing but the digits it does not have.
double SplineBasis::Wrap(double u) const {
  if (std::isinf(u)) {
    throw std::invalid_argument(
        "SplineBasis::Clamp: u is infinite; a periodic basis needs a place");
  }
  const double period = upper() - lower();
  double past = std::fmod(std::fmod(u, period) - std::fmod(lower(), period), period);
  if (past < 0) past += period;
  const double wrapped = lower() + past;
  return wrapped < upper() ? wrapped : lower();
}

int SplineBasis::Multiplicity(double knot) const {
  return static_cast<int>(std::count(knots_.begin(), knots_.end(), knot));
}

}  // namespace batten
