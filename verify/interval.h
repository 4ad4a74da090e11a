// SPDX-License-Identifier: MIT
// Numbers known to lie between two doubles. Every operation is rounded outwards.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

namespace verify {

constexpr double kAll = std::numeric_limits<double>::infinity();

// One operation in the nearest rounding errs by half a unit in the last place: below by less than
// |x|·2^-52, plus the least number there is where it underflows. What overflowed is not known.
inline double Down(double x) {
  const double down = x - (std::abs(x) * 0x1p-52 + std::numeric_limits<double>::denorm_min());
  return std::isfinite(down) ? down : -kAll;
}
inline double Up(double x) { return -Down(-x); }

struct Interval {
  double lo = 0, hi = 0;
  Interval() = default;
  Interval(double value) : lo(value), hi(value) {}  // NOLINT: numbers are intervals
  Interval(double low, double high) : lo(low), hi(high) {}
};

inline Interval operator-(const Interval& a) { return {-a.hi, -a.lo}; }
inline Interval operator+(const Interval& a, const Interval& b) {
  return {Down(a.lo + b.lo), Up(a.hi + b.hi)};
}
inline Interval operator-(const Interval& a, const Interval& b) {
  return {Down(a.lo - b.hi), Up(a.hi - b.lo)};
}
inline Interval operator*(const Interval& a, const Interval& b) {
  const double p = a.lo * b.lo, q = a.lo * b.hi, r = a.hi * b.lo, s = a.hi * b.hi;
  if (!std::isfinite(p + q + r + s)) return {-kAll, kAll};
  return {Down(std::min(std::min(p, q), std::min(r, s))),
          Up(std::max(std::max(p, q), std::max(r, s)))};
}
// Of a divisor that does not hold zero; else all numbers.
inline Interval operator/(const Interval& a, const Interval& b) {
  if (b.lo <= 0 && b.hi >= 0) return {-kAll, kAll};
  const double p = a.lo / b.lo, q = a.lo / b.hi, r = a.hi / b.lo, s = a.hi / b.hi;
  if (!std::isfinite(p + q + r + s)) return {-kAll, kAll};
  return {Down(std::min(std::min(p, q), std::min(r, s))),
          Up(std::max(std::max(p, q), std::max(r, s)))};
}
inline Interval& operator+=(Interval& a, const Interval& b) { return a = a + b; }
inline Interval Square(const Interval& a) {
  const double p = a.lo * a.lo, q = a.hi * a.hi;
  const double least = a.lo <= 0 && a.hi >= 0 ? 0 : std::max(0.0, Down(std::min(p, q)));
  return {least, Up(std::max(p, q))};
}
inline Interval Half(const Interval& a, const Interval& b) { return (a + b) * Interval(0.5); }
inline Interval Root(const Interval& a) {
  return {std::max(0.0, Down(std::sqrt(std::max(0.0, a.lo)))), Up(std::sqrt(std::max(0.0, a.hi)))};
}

}  // namespace verify
