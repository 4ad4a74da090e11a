// SPDX-License-Identifier: MIT
#include "geometry/bezier/bernstein_polynomial.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "random_splines.h"
#include "tolerances.h"

namespace batten::internal::bernstein_polynomial_test {

// A random polynomial with the room that the functions may read past its end.
struct Polynomial {
  int m, n;
  std::vector<double> f;

  Polynomial(int degree_x, int degree_y) : m(degree_x), n(degree_y), f(Count() + kReadPast, 0.0) {}
  Polynomial(RandomSplines& random, int most)
      : Polynomial(random.Integer(0, most), random.Integer(0, most)) {
    for (int k = 0; k < Count(); ++k) f[k] = random.Real(-1, 1);
  }
  int Count() const { return (m + 1) * (n + 1); }
  PolynomialJet At(double x, double y) const { return EvaluateBernstein(f.data(), m, n, x, y); }

  // De Casteljau in both variables, independent of the code under test.
  double Value(double x, double y) const {
    std::vector<double> rows(m + 1);
    for (int k = 0; k <= m; ++k) {
      std::vector<double> row(f.begin() + k * (n + 1), f.begin() + (k + 1) * (n + 1));
      for (int level = n; level > 0; --level) {
        for (int l = 0; l < level; ++l) row[l] = (1 - y) * row[l] + y * row[l + 1];
      }
      rows[k] = row[0];
    }
    for (int level = m; level > 0; --level) {
      for (int k = 0; k < level; ++k) rows[k] = (1 - x) * rows[k] + x * rows[k + 1];
    }
    return rows[0];
  }
};

TEST(BernsteinPolynomialTest, ValueIsDeCasteljausAndDerivativesAreDifferences) {
  RandomSplines random(1);
  for (int trial = 0; trial < 400; ++trial) {
    SCOPED_TRACE("trial " + std::to_string(trial));
    const Polynomial p(random, 22);
    const double x = random.Real(0.01, 0.99), y = random.Real(0.01, 0.99), h = 1e-4;
    const PolynomialJet jet = p.At(x, y);
    EXPECT_NEAR(jet.value, p.Value(x, y), kRounding);
    // Central differences: h² times a third derivative, which m³ bounds.
    const double most = std::max({p.m, p.n, 1}), error = 20 * h * h * most * most * most;
    EXPECT_NEAR(jet.gx, (p.Value(x + h, y) - p.Value(x - h, y)) / (2 * h), error);
    EXPECT_NEAR(jet.gy, (p.Value(x, y + h) - p.Value(x, y - h)) / (2 * h), error);
    EXPECT_NEAR(jet.hxx, (p.At(x + h, y).gx - p.At(x - h, y).gx) / (2 * h), error * most);
    EXPECT_NEAR(jet.hxy, (p.At(x, y + h).gx - p.At(x, y - h).gx) / (2 * h), error * most);
    EXPECT_NEAR(jet.hyy, (p.At(x, y + h).gy - p.At(x, y - h).gy) / (2 * h), error * most);
  }
}

TEST(BernsteinPolynomialTest, WhatDifferencesProveHolds) {
  RandomSplines random(2);
  int convex = 0, rising = 0;
  for (int trial = 0; trial < 4000; ++trial) {
    SCOPED_TRACE("trial " + std::to_string(trial));
    Polynomial p(random, 9);
    // A bowl and a slope, so that all answers occur.
    const double bowl = random.Real(0, 20), slope = random.Real(-3, 3);
    for (int k = 0; k < p.Count(); ++k) {
      const double s = p.m > 0 ? double(k / (p.n + 1)) / p.m : 0;
      const double t = p.n > 0 ? double(k % (p.n + 1)) / p.n : 0;
      p.f[k] = 0.05 * p.f[k] + bowl * ((s - 0.4) * (s - 0.4) + (t - 0.5) * (t - 0.5)) + slope * s;
    }
    const PolynomialBounds bounds = BoundsOf(p.f.data(), p.m, p.n);
    convex += bounds.lowest > 0;
    rising += bounds.rises_x;
    EXPECT_LE(LeastCoefficient(p.f.data(), p.Count()), p.Value(0.3, 0.6));
    for (int place = 0; place < 10; ++place) {
      const PolynomialJet jet = p.At(random.Real(0, 1), random.Real(0, 1));
      const double rounding = kRounding * (1 + bowl);
      if (bounds.rises_x) {
        EXPECT_GE(jet.gx, -rounding * p.m);
      }
      if (bounds.falls_x) {
        EXPECT_LE(jet.gx, rounding * p.m);
      }
      if (bounds.rises_y) {
        EXPECT_GE(jet.gy, -rounding * p.n);
      }
      if (bounds.falls_y) {
        EXPECT_LE(jet.gy, rounding * p.n);
      }
      double lowest = p.m == 0 ? jet.hyy : jet.hxx;
      if (p.m > 0 && p.n > 0) {
        lowest = (jet.hxx + jet.hyy) / 2 - std::hypot((jet.hxx - jet.hyy) / 2, jet.hxy);
      }
      EXPECT_GE(lowest, bounds.lowest - 100 * rounding);
    }
  }
  EXPECT_GT(convex, 100);
  EXPECT_GT(rising, 100);
}

TEST(BernsteinPolynomialTest, HalvesTakeTheValuesOfTheWhole) {
  RandomSplines random(3);
  for (int trial = 0; trial < 400; ++trial) {
    SCOPED_TRACE("trial " + std::to_string(trial));
    const Polynomial p(random, 12);
    Polynomial low(p.m, p.n), high(p.m, p.n);
    const bool first = random.Coin();
    (first ? HalveFirst : HalveSecond)(p.f.data(), p.m, p.n, 1, low.f.data(), high.f.data());
    const double x = random.Real(0, 1), y = random.Real(0, 1);
    EXPECT_NEAR(low.Value(x, y), first ? p.Value(x / 2, y) : p.Value(x, y / 2), kRounding);
    EXPECT_NEAR(
        high.Value(x, y), first ? p.Value((1 + x) / 2, y) : p.Value(x, (1 + y) / 2), kRounding);
  }
}

TEST(BernsteinPolynomialTest, ProductTakesTheProductOfTheValues) {
  RandomSplines random(4);
  for (int trial = 0; trial < 200; ++trial) {
    SCOPED_TRACE("trial " + std::to_string(trial));
    const Polynomial a(random, 11);
    Polynomial b(a.m, a.n), product(2 * a.m, 2 * a.n);
    for (int k = 0; k < b.Count(); ++k) b.f[k] = random.Real(-1, 1);
    AddProduct(a.f.data(), b.f.data(), a.m, a.n, -3, product.f.data());
    const double x = random.Real(0, 1), y = random.Real(0, 1);
    EXPECT_NEAR(product.Value(x, y), -3 * a.Value(x, y) * b.Value(x, y), kRounding);
  }
}

}  // namespace batten::internal::bernstein_polynomial_test
