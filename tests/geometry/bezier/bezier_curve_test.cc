// SPDX-License-Identifier: MIT
#include "batten/geometry/bezier_curve.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "geometry/bezier/bernstein.h"
#include "batten/geometry/bezier_reduction.h"
#include "geometry/nurbs/rational_derivatives.h"
#include "fixtures.h"
#include "random_splines.h"
#include "tolerances.h"

namespace batten::internal::bezier_curve_test {

template <int Dim>
BezierCurve<Dim> RandomCurve(RandomSplines& random,
                             int degree,
                             bool rational,
                             double weight = 1e2) {
  Eigen::Matrix<double, Dim, Eigen::Dynamic> points(Dim, degree + 1);
  for (double& x : points.reshaped()) x = random.Real(-1, 1);
  return BezierCurve<Dim>(
      points, rational ? random.Weights(degree + 1, 1 / weight, weight) : Eigen::VectorXd());
}

// Calls check(curve, random) for curves of every degree, both dimensions, with and without weights.
template <typename Check>
void ForRandomCurves(int lowest, int highest, const Check& check) {
  for (int degree = lowest; degree <= highest; ++degree) {
    for (int seed = 0; seed < 8; ++seed) {
      const bool rational = seed % 2 == 1;
      SCOPED_TRACE("degree " + std::to_string(degree) + ", seed " + std::to_string(seed));
      RandomSplines random(100 * degree + seed);
      check(RandomCurve<2>(random, degree, rational), random);
      check(RandomCurve<3>(random, degree, rational), random);
    }
  }
}

std::vector<double> Parameters(RandomSplines& random) {
  return {0, 1, 0.5, random.Real(0, 1), random.Real(0, 1), 1e-12, 1 - 1e-12};
}

TEST(BernsteinTest, PolynomialsArePositiveAndSumToOne) {
  for (int n = 0; n <= kMaxBezierDegree; ++n) {
    RandomSplines random(n);
    for (const double t : Parameters(random)) {
      Eigen::VectorXd B(n + 1);
      BernsteinValues(n, t, B.data());
      EXPECT_GE(B.minCoeff(), 0);
      EXPECT_NEAR(B.sum(), 1, kRounding);
      for (int i = 0; i <= n; ++i) {
        const double direct = Binomial(n, i) * std::pow(t, i) * std::pow(1 - t, n - i);
        // 1e-300: where numbers lose digits because they are so small.
        EXPECT_NEAR(B[i], direct, kRounding * direct + 1e-300)
            << "n " << n << ", i " << i << ", t " << t;
      }
    }
  }
}

TEST(BernsteinTest, DerivativesAreThoseOfTheBasisOfOneSpan) {
  for (int n = 1; n <= 11; ++n) {
    RandomSplines random(n);
    const SplineBasis basis = SplineBasis::Uniform(n, n + 1, 0, 1);
    for (const double t : Parameters(random)) {
      constexpr int kOrder = 13;
      Eigen::MatrixXd got(n + 1, kOrder + 1), wanted(n + 1, kOrder + 1);
      BernsteinDerivatives(n, t, kOrder, got.data());
      basis.Derivatives(n, t, kOrder, wanted.data());
      for (int k = 0; k <= kOrder; ++k) {
        const double scale = std::max(1.0, wanted.col(k).cwiseAbs().maxCoeff());
        EXPECT_LE((got.col(k) - wanted.col(k)).cwiseAbs().maxCoeff(), kRounding * scale);
      }
    }
  }
}

TEST(BernsteinTest, ProductsSplitsAndRestrictionsAreThoseOfTheFunctions) {
  for (int seed = 0; seed < 100; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const int m = random.Integer(0, 11), n = random.Integer(0, 11);
    Eigen::MatrixXd f(3, m + 1), g(1, n + 1);
    for (double& x : f.reshaped()) x = random.Real(-1, 1);
    for (double& x : g.reshaped()) x = random.Real(-1, 1);
    const Eigen::MatrixXd product = BernsteinProduct(f, g);
    const double a = random.Real(0, 0.9), b = random.Real(a + 0.01, 1), t = random.Real(0, 1);
    const auto close = [](const Eigen::VectorXd& x, const Eigen::VectorXd& y) {
      return (x - y).norm() <= kRounding;
    };
    EXPECT_TRUE(close(DeCasteljau(product, t), DeCasteljau(f, t) * DeCasteljau(g, t)[0]));
    EXPECT_TRUE(close(DeCasteljau(ElevatedBernstein(f, n), t), DeCasteljau(f, t)));
    EXPECT_TRUE(
        close(DeCasteljau(RestrictedBernstein(f, a, b), t), DeCasteljau(f, a + t * (b - a))));
    const auto [left, right] = SplitBernstein(f, a);
    EXPECT_TRUE(close(DeCasteljau(left, t), DeCasteljau(f, a * t)));
    EXPECT_TRUE(close(DeCasteljau(right, t), DeCasteljau(f, a + t * (1 - a))));
  }
}

TEST(BezierCurveTest, PointsAndDerivativesAreThoseOfTheNurbsCurveOfOneSpan) {
  ForRandomCurves(1, 11, [](const auto& curve, RandomSplines& random) {
    const auto nurbs = ToNurbs(curve);
    EXPECT_EQ(curve.rational(), nurbs.rational());
    for (const double t : Parameters(random)) {
      EXPECT_LE((curve.At(t) - nurbs.At(t)).norm(), kRounding);
      const auto got = curve.Derivatives(t, 4), wanted = nurbs.Derivatives(t, 4);
      for (int k = 0; k <= 4; ++k) {
        const double scale = std::max(1.0, wanted.leftCols(k + 1).cwiseAbs().maxCoeff());
        EXPECT_LE((got.col(k) - wanted.col(k)).norm(), 1e4 * kRounding * scale);
      }
    }
  });
}

TEST(BezierCurveTest, LiesInTheBoxOfItsControlPoints) {
  ForRandomCurves(1, 11, [](const auto& curve, RandomSplines& random) {
    const auto low = curve.control_points().rowwise().minCoeff().eval();
    const auto high = curve.control_points().rowwise().maxCoeff().eval();
    for (const double t : Parameters(random)) {
      const auto point = curve.At(t);
      EXPECT_GE((point - low).minCoeff(), -kRounding);
      EXPECT_GE((high - point).minCoeff(), -kRounding);
    }
  });
}

TEST(BezierCurveTest, ParametersOutsideAreTakenAtTheEnds) {
  RandomSplines random(1);
  const BezierCurve<3> curve = RandomCurve<3>(random, 5, true);
  EXPECT_EQ(curve.At(-0.5), curve.control_points().col(0));
  EXPECT_EQ(curve.At(1.5), curve.control_points().col(5));
}

// A line crosses a plane curve at most as often as its control polygon.
TEST(BezierCurveTest, DiminishesVariation) {
  const auto changes = [](const Eigen::VectorXd& heights) {
    int count = 0;
    double last = 0;
    for (const double h : heights) {
      if (h == 0) continue;
      if (last * h < 0) ++count;
      last = h;
    }
    return count;
  };
  ForRandomCurves(1, 11, [&](const auto& curve, RandomSplines& random) {
    const auto low = Homogeneous(Elevated(curve, 2));
    const auto original = Homogeneous(curve);
    for (int line = 0; line < 10; ++line) {
      Eigen::VectorXd normal(original.rows());
      for (double& x : normal) x = random.Real(-1, 1);
      Eigen::VectorXd samples(200);
      for (int k = 0; k < 200; ++k) {
        samples[k] =
            curve.At(k / 199.0).dot(normal.head(normal.size() - 1)) + normal[normal.size() - 1];
      }
      const int polygon = changes(original.transpose() * normal);
      EXPECT_LE(changes(samples), polygon);
      EXPECT_LE(changes(low.transpose() * normal), polygon);
    }
  });
}

TEST(BezierCurveTest, HodographIsTheCurveOfFirstDerivatives) {
  ForRandomCurves(0, 11, [](const auto& curve, RandomSplines& random) {
    const auto hodograph = Hodograph(curve);
    EXPECT_EQ(hodograph.degree(),
              curve.rational() ? 2 * curve.degree() : std::max(curve.degree() - 1, 0));
    for (const double t : Parameters(random)) {
      const auto wanted = curve.Derivatives(t, 1).col(1).eval();
      // Weights up to 1e2 against 1e-2: derivatives up to 1e4, and as much again in the quotient.
      const double scale = std::max(1.0, hodograph.control_points().cwiseAbs().maxCoeff());
      EXPECT_LE((hodograph.At(t) - wanted).norm(), kRounding * scale);
    }
  });
}

TEST(BezierCurveTest, EndDerivativesAreDerivativesAtTheEnds) {
  ForRandomCurves(0, 11, [](const auto& curve, RandomSplines&) {
    for (const CurveEnd end : {CurveEnd::kStart, CurveEnd::kEnd}) {
      const auto got = EndDerivatives(curve, end);
      const auto wanted = curve.Derivatives(end == CurveEnd::kStart ? 0 : 1, 2);
      for (int k = 0; k <= 2; ++k) {
        const double scale = std::max(1.0, wanted.cwiseAbs().maxCoeff());
        EXPECT_LE((got.col(k) - wanted.col(k)).norm(), kRounding * scale) << "order " << k;
      }
    }
  });
}

TEST(BezierCurveTest, SubdivisionTracesTheSameCurve) {
  ForRandomCurves(0, 11, [](const auto& curve, RandomSplines& random) {
    const double cut = random.Real(0.01, 0.99);
    const auto [left, right] = Subdivided(curve, cut);
    EXPECT_EQ(left.degree(), curve.degree());
    for (const double t : Parameters(random)) {
      EXPECT_LE((left.At(t) - curve.At(cut * t)).norm(), kRounding);
      EXPECT_LE((right.At(t) - curve.At(cut + t * (1 - cut))).norm(), kRounding);
    }
  });
}

TEST(BezierCurveTest, ElevationChangesNoPoint) {
  ForRandomCurves(0, 11, [](const auto& curve, RandomSplines& random) {
    const int by = random.Integer(0, 14);
    const auto elevated = Elevated(curve, by);
    EXPECT_EQ(elevated.degree(), curve.degree() + by);
    const double bound = 8 * (elevated.degree() + 1) * std::numeric_limits<double>::epsilon();
    for (const double t : Parameters(random)) {
      EXPECT_LE((elevated.At(t) - curve.At(t)).cwiseAbs().maxCoeff(), bound);
    }
  });
}

TEST(BezierCurveTest, ElevationOfTheLectureNoteComesOutAsPrinted) {
  fixtures::CheckAll("worked_examples.json",
                     [](const auto& input, const auto& expected, double tolerance) {
                       if (!input.contains("op") || input.at("op") != "elevate") return;
                       const BezierCurve<2> curve(fixtures::Columns(input.at("points")));
                       const int by = input.at("to_degree").template get<int>() - curve.degree();
                       fixtures::ExpectClose(Elevated(curve, by).control_points(),
                                             fixtures::Columns(expected.at("points")),
                                             tolerance);
                     });
}

TEST(BezierCurveTest, InterpolationGoesThroughThePoints) {
  for (int n = 0; n <= 15; ++n) {
    SCOPED_TRACE("degree " + std::to_string(n));
    RandomSplines random(n);
    Eigen::Matrix3Xd points(3, n + 1);
    for (double& x : points.reshaped()) x = random.Real(-1, 1);
    std::vector<double> parameters(n + 1);
    for (int k = 0; k <= n; ++k) parameters[k] = (k + random.Real(0.2, 0.8)) / (n + 1);
    const BezierCurve<3> through = InterpolatingBezierCurve<3>(points, parameters);
    const BezierCurve<3> uniform = InterpolatingBezierCurve<3>(points);
    EXPECT_EQ(through.degree(), n);
    const double size = through.control_points().cwiseAbs().maxCoeff();
    for (int k = 0; k <= n; ++k) {
      EXPECT_LE((through.At(parameters[k]) - points.col(k)).norm(), kRounding * size);
      EXPECT_LE((uniform.At(n == 0 ? 0 : double(k) / n) - points.col(k)).norm(),
                kRounding * uniform.control_points().cwiseAbs().maxCoeff());
    }
  }
}

TEST(BezierCurveTest, InterpolationFindsAPolynomialAgain) {
  for (int n = 1; n <= 8; ++n) {
    RandomSplines random(n);
    const BezierCurve<2> curve = RandomCurve<2>(random, n, false);
    Eigen::Matrix2Xd points(2, n + 1);
    for (int k = 0; k <= n; ++k) points.col(k) = curve.At(double(k) / n);
    const BezierCurve<2> again = InterpolatingBezierCurve<2>(points);
    // The condition of the problem grows as 3^n or so.
    EXPECT_LE((again.control_points() - curve.control_points()).cwiseAbs().maxCoeff(),
              std::pow(3, n) * kRounding);
  }
}

TEST(BezierCurveTest, ConvertsToNurbsAndBack) {
  ForRandomCurves(1, 11, [](const auto& curve, RandomSplines& random) {
    const auto nurbs = ToNurbs(curve, -3.0, 5.0);
    const double t = random.Real(0, 1);
    EXPECT_LE((nurbs.At(-3 + 8 * t) - curve.At(t)).norm(), kRounding);
    const auto back = ToBezier(nurbs);
    EXPECT_LE((back.control_points() - curve.control_points()).cwiseAbs().maxCoeff(), kRounding);
  });
  for (int seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE("unclamped, seed " + std::to_string(seed));
    RandomSplines random(seed);
    const NurbsCurve<3> nurbs =
        random.Curve<3>(random.Integer(1, 11), true, {.clamped = false, .most_spans = 1});
    const BezierCurve<3> curve = ToBezier(nurbs);
    const double a = nurbs.basis().lower(), b = nurbs.basis().upper(), t = random.Real(0, 1);
    EXPECT_LE((curve.At(t) - nurbs.At(a + t * (b - a))).norm(), kRounding);
  }
}

TEST(BezierCurveTest, RefusesWhatItCannotMean) {
  RandomSplines random(3);
  const BezierCurve<2> curve = RandomCurve<2>(random, 3, false);
  const Eigen::Matrix2Xd points = curve.control_points();
  EXPECT_THROW(BezierCurve<2>(Eigen::Matrix2Xd(2, 0)), std::invalid_argument);
  EXPECT_THROW(BezierCurve<2>(Eigen::Matrix2Xd::Zero(2, 52)), std::invalid_argument);
  EXPECT_THROW(BezierCurve<2>(points, Eigen::Vector4d(1, 0, 1, 1)), std::invalid_argument);
  EXPECT_THROW(BezierCurve<2>(points, Eigen::Vector3d(1, 1, 1)), std::invalid_argument);
  EXPECT_THROW(BezierCurve<2>(points / 0.0), std::invalid_argument);
  EXPECT_THROW(Subdivided(curve, 0.0), std::invalid_argument);
  EXPECT_THROW(Subdivided(curve, std::nan("")), std::invalid_argument);
  EXPECT_THROW(Elevated(curve, -1), std::invalid_argument);
  EXPECT_THROW(Elevated(curve, std::numeric_limits<int>::max()), std::invalid_argument);
  EXPECT_THROW(ToNurbs(curve, 1.0, 1.0), std::invalid_argument);
  EXPECT_THROW(ToNurbs(Elevated(curve, 30)), std::invalid_argument);
  EXPECT_THROW(Hodograph(RandomCurve<2>(random, 26, true)), std::invalid_argument);
  EXPECT_THROW(ToBezier(NurbsCurve<2>(SplineBasis::Uniform(2, 4, 0, 1), points)),
               std::invalid_argument);
  EXPECT_THROW(InterpolatingBezierCurve<2>(points, std::vector<double>{0, 0.5, 0.5, 1}),
               std::invalid_argument);
  EXPECT_THROW(InterpolatingBezierCurve<2>(points, std::vector<double>{0, 0.5, 1}),
               std::invalid_argument);
  EXPECT_THROW(InterpolatingBezierCurve<2>(points, std::vector<double>{0, 0.5, 0.7, 1.1}),
               std::invalid_argument);
}

constexpr BezierReductionRule kRules[] = {BezierReductionRule::kForward,
                                          BezierReductionRule::kBackward,
                                          BezierReductionRule::kLeastSquares,
                                          BezierReductionRule::kLeastSquaresFixedEnds};

template <typename Curve>
double Sampled(const Curve& a, const Curve& b, int samples) {
  double most = 0;
  for (int k = 0; k <= samples; ++k) {
    most = std::max(most, (a.At(double(k) / samples) - b.At(double(k) / samples)).norm());
  }
  return most;
}

TEST(BezierReductionTest, UndoesElevation) {
  ForRandomCurves(2, 11, [](const auto& curve, RandomSplines&) {
    for (const BezierReductionRule rule : kRules) {
      const auto back = Reduced(Elevated(curve), rule);
      const bool least_squares = rule == BezierReductionRule::kLeastSquares ||
                                 rule == BezierReductionRule::kLeastSquaresFixedEnds;
      // One-sided: 2^n roundings, relative to the largest weight where there are weights; a small
      // weight may then even be lost.
      if (!least_squares && curve.rational() && curve.degree() > 5) continue;
      const double bound =
          least_squares ? kRounding
                        : kRounding * std::pow(2, curve.degree()) * (curve.rational() ? 1e4 : 1);
      ASSERT_TRUE(back);
      EXPECT_EQ(back->curve.degree(), curve.degree());
      EXPECT_LE(back->error, bound);
      EXPECT_LE(Sampled(back->curve, curve, 20), bound);
    }
  });
}

TEST(BezierReductionTest, ErrorBoundsTheDeviationAndIsWithinOnePerCent) {
  ForRandomCurves(2, 11, [](const auto& curve, RandomSplines&) {
    for (const BezierReductionRule rule : kRules) {
      const auto reduced = Reduced(curve, rule);
      if (!reduced) {
        EXPECT_TRUE(curve.rational());
        continue;
      }
      const double sampled = Sampled(reduced->curve, curve, 2000);
      EXPECT_GE(reduced->error, sampled * (1 - kRounding));
      // Weights that differ by 1e4 hide narrow peaks from the samples.
      if (!curve.rational()) {
        EXPECT_LE(reduced->error, 1.011 * sampled + kRounding);
      }
    }
  });
}

TEST(BezierReductionTest, OneSidedRulesKeepTheDerivativesAtTheirSide) {
  ForRandomCurves(2, 8, [](const auto& curve, RandomSplines&) {
    if (curve.rational()) return;
    const int n = curve.degree();
    const auto forward = Reduced(curve, BezierReductionRule::kForward);
    const auto backward = Reduced(curve, BezierReductionRule::kBackward);
    for (const double t : {0.0, 1.0}) {
      const auto got = (t == 0 ? forward : backward)->curve.Derivatives(t, n - 1);
      const auto wanted = curve.Derivatives(t, n - 1);
      EXPECT_LE((got - wanted).norm(), 1e3 * kRounding * wanted.norm());
    }
    // The difference is the last defect times t^n.
    const auto last = forward->curve.control_points().col(n - 1).eval();
    EXPECT_NEAR(forward->error, (curve.control_points().col(n) - last).norm(), 1e-9);
  });
}

// The difference is orthogonal to every polynomial of degree n−1: ∫ B_{i,n} B_{k,n−1} dt =
// C(n,i) C(n−1,k) / (2n C(2n−1, i+k)).
TEST(BezierReductionTest, LeastSquaresIsNearestInTheMeanSquare) {
  ForRandomCurves(2, 11, [](const auto& curve, RandomSplines&) {
    if (curve.rational()) return;
    const int n = curve.degree();
    const auto reduced = Reduced(curve, BezierReductionRule::kLeastSquares);
    const auto difference =
        (Elevated(reduced->curve).control_points() - curve.control_points()).eval();
    for (int k = 0; k < n; ++k) {
      auto integral = difference.col(0).eval();
      integral.setZero();
      for (int i = 0; i <= n; ++i) {
        integral += Binomial(n, i) * Binomial(n - 1, k) / (2 * n * Binomial(2 * n - 1, i + k)) *
                    difference.col(i);
      }
      EXPECT_LE(integral.norm(), kRounding);
    }
  });
}

TEST(BezierReductionTest, FixedEndsStay) {
  ForRandomCurves(2, 11, [](const auto& curve, RandomSplines&) {
    const auto reduced = Reduced(curve, BezierReductionRule::kLeastSquaresFixedEnds);
    if (!reduced) return;
    const int n = curve.degree();
    EXPECT_LE((reduced->curve.At(0) - curve.At(0)).norm(), kRounding);
    EXPECT_LE((reduced->curve.At(1) - curve.control_points().col(n)).norm(), kRounding);
  });
}

TEST(BezierReductionTest, RefusesPoints) {
  const BezierCurve<2> line(Eigen::Matrix2d::Identity());
  for (const BezierReductionRule rule : kRules) {
    EXPECT_THROW(Reduced(BezierCurve<2>(Eigen::Vector2d(1, 2)), rule), std::invalid_argument);
  }
  EXPECT_THROW(Reduced(line, BezierReductionRule::kLeastSquaresFixedEnds), std::invalid_argument);
  EXPECT_NEAR(Reduced(line, BezierReductionRule::kLeastSquares)->error, std::sqrt(0.5), kRounding);
}

}  // namespace batten::internal::bezier_curve_test
