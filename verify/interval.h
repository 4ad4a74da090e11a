// SPDX-License-Identifier: MIT
// Numbers known to lie between two doubles. Every operation is rounded outwards.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

namespace verify {

// One operation in the nearest rounding errs by half a unit in the last place: below by less than
// |x|·2^-52, plus the least number there is where it underflows. What overflows becomes NaN, of
// which nothing is proved: 0 times the operands passes it on where minima would lose it.
inline double Down(double x) {
  return x - (std::abs(x) * 0x1p-52 + std::numeric_limits<double>::denorm_min());
}
inline double Up(double x) {
  return x + (std::abs(x) * 0x1p-52 + std::numeric_limits<double>::denorm_min());
}

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
inline Interval Hull(double p, double q, double r, double s) {
  const double lost = 0 * ((p + q) + (r + s));
  return {Down(std::min(std::min(p, q), std::min(r, s))) + lost,
          Up(std::max(std::max(p, q), std::max(r, s))) + lost};
}
inline Interval operator*(const Interval& a, const Interval& b) {
  return Hull(a.lo * b.lo, a.lo * b.hi, a.hi * b.lo, a.hi * b.hi);
}
inline Interval operator/(const Interval& a, const Interval& b) {
  if (!(b.lo > 0 || b.hi < 0)) return {NAN, NAN};
  return Hull(a.lo / b.lo, a.lo / b.hi, a.hi / b.lo, a.hi / b.hi);
}
inline Interval Hull(const Interval& a, const Interval& b) {
  const double lost = 0 * (a.lo + b.lo);
  return {std::min(a.lo, b.lo) + lost, std::max(a.hi, b.hi) + lost};
}
inline Interval& operator+=(Interval& a, const Interval& b) { return a = a + b; }
inline Interval Square(const Interval& a) {
  const double p = a.lo * a.lo, q = a.hi * a.hi;
  const double least = a.lo <= 0 && a.hi >= 0 ? 0 : std::max(0.0, Down(std::min(p, q)));
  return {least, Up(std::max(p, q)) + 0 * (p + q)};
}
inline Interval Half(const Interval& a, const Interval& b) { return (a + b) * Interval(0.5); }
inline Interval Root(const Interval& a) {
  return {std::max(0.0, Down(std::sqrt(std::max(0.0, a.lo)))), Up(std::sqrt(a.hi))};
}

}  // namespace verify
