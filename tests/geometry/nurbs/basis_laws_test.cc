// SPDX-License-Identifier: MIT
// What every B-spline basis obeys: the properties of [Piegl & Tiller 1997, §2.2–2.4], over random
// bases.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "batten/geometry/spline_basis.h"
#include "extended_evaluation.h"
#include "law_cases.h"
#include "tolerances.h"

namespace batten::internal::basis_laws_test {

std::vector<double> Values(const SplineBasis& basis, int span, double u) {
  std::vector<double> values(basis.degree() + 1);
  basis.Values(span, u, values.data());
  return values;
}

// Row k: the derivatives of order k of the functions on the span.
Eigen::MatrixXd Derivatives(const SplineBasis& basis, int span, double u, int order) {
  Eigen::MatrixXd values(basis.degree() + 1, order + 1);
  basis.Derivatives(span, u, order, values.data());
  return values.transpose();
}

// N_{i,p}(u) by the recursion of Cox and de Boor, word for word; the upper end of the domain counts
// to the span before it.
double CoxDeBoor(const SplineBasis& basis, int i, int p, double u) {
  const std::vector<double>& U = basis.knots();
  if (p == 0) return i == basis.Span(u) ? 1 : 0;
  const double left = U[i + p] - U[i], right = U[i + p + 1] - U[i + 1];
  return (left > 0 ? (u - U[i]) / left * CoxDeBoor(basis, i, p - 1, u) : 0) +
         (right > 0 ? (U[i + p + 1] - u) / right * CoxDeBoor(basis, i + 1, p - 1, u) : 0);
}

// `count` parameters inside every span, in increasing order.
std::vector<double> Inside(const SplineBasis& basis, int count) {
  std::vector<double> parameters;
  for (const int span : basis.Spans()) {
    const double a = basis.knots()[span], b = basis.knots()[span + 1];
    for (int k = 0; k < count; ++k) parameters.push_back(a + (b - a) * (k + 0.5) / count);
  }
  return parameters;
}

// The inner knots, each once.
std::vector<double> InnerKnots(const SplineBasis& basis) {
  std::vector<double> knots;
  for (const int span : basis.Spans()) knots.push_back(basis.knots()[span]);
  knots.erase(knots.begin());
  return knots;
}

TEST(BasisLawsTest, SumsToOneOnTheClosedDomain) {
  ForRandomBases([](const SplineBasis& basis, RandomSplines& random) {
    for (int trial = 0; trial < 20; ++trial) {
      const double u = random.Parameter(basis);
      double sum = 0;
      for (const double value : Values(basis, basis.Span(u), u)) sum += value;
      EXPECT_NEAR(sum, 1, 4 * basis.degree() * kEpsilon) << "u = " << u;
    }
  });
}

TEST(BasisLawsTest, IsNowhereNegative) {
  ForRandomBases([](const SplineBasis& basis, RandomSplines& random) {
    for (int trial = 0; trial < 20; ++trial) {
      const double u = random.Parameter(basis);
      EXPECT_THAT(Values(basis, basis.Span(u), u), testing::Each(testing::Ge(0.0))) << "u = " << u;
    }
  });
}

TEST(BasisLawsTest, EqualsTheRecursionInsideItsSupportAndVanishesOutside) {
  ForRandomBases(
      [](const SplineBasis& basis, RandomSplines& random) {
        for (int trial = 0; trial < 5; ++trial) {
          const double u = random.Parameter(basis);
          const int span = basis.Span(u), p = basis.degree();
          const std::vector<double> values = Values(basis, span, u);
          for (int i = 0; i < basis.size(); ++i) {
            const bool reached = span - p <= i && i <= span;
            EXPECT_NEAR(CoxDeBoor(basis, i, p, u), reached ? values[i - span + p] : 0, kRounding)
                << "N_" << i << " at " << u;
            EXPECT_EQ(basis.Function(i, u), reached ? values[i - span + p] : 0);
            const double low = basis.knots()[i], high = basis.knots()[i + p + 1];
            if (u < low || u > high) {
              EXPECT_FALSE(reached);
            }
            if (low < u && u < high) {
              EXPECT_GT(basis.Function(i, u), 0) << "N_" << i << " at " << u;
            }
          }
        }
      },
      6,
      7);  // the plain recursion costs 2^p
}

// Header: 3p·ε of each value.
TEST(BasisLawsTest, EveryValueIsRightToItsBound) {
  ForRandomBases([](const SplineBasis& basis, RandomSplines& random) {
    const int p = basis.degree();
    for (int trial = 0; trial < 5; ++trial) {
      const double u = random.Parameter(basis);
      const int span = basis.Span(u);
      const std::vector<double> values = Values(basis, span, u);
      const Sized exact = ExtendedBasis(basis, span, u, 0);
      for (int r = 0; r <= p; ++r) {
        const double value = static_cast<double>(exact.value(r, 0));
        EXPECT_LE(std::abs(static_cast<double>(values[r] - exact.value(r, 0))),
                  3 * p * kEpsilon * value)
            << values[r];
      }
    }
  });
}

// Header: 3p·ε of the sum of absolute terms, and that sum at most p!/(p−k)!·(2/h)^k.
TEST(BasisLawsTest, EveryDerivativeIsRightToItsBound) {
  ForRandomBases([](const SplineBasis& basis, RandomSplines& random) {
    const int p = basis.degree();
    for (int trial = 0; trial < 5; ++trial) {
      const double u = random.Parameter(basis);
      const int span = basis.Span(u);
      const double length = basis.knots()[span + 1] - basis.knots()[span];
      const Eigen::MatrixXd derivatives = Derivatives(basis, span, u, p);
      const Sized exact = ExtendedBasis(basis, span, u, p);
      double most = 1;
      for (int k = 0; k <= p; ++k) {
        for (int r = 0; r <= p; ++r) {
          EXPECT_LE(std::abs(static_cast<double>(derivatives(k, r) - exact.value(r, k))),
                    3 * p * kEpsilon * static_cast<double>(exact.size(r, k)))
              << "order " << k << ", function " << r;
        }
        EXPECT_LE(static_cast<double>(exact.size.col(k).sum()), most * (1 + kRounding));
        most *= (p - k) * 2 / length;
      }
    }
  });
}

TEST(BasisLawsTest, DerivativesOfOrderZeroAreTheValues) {
  ForRandomBases([](const SplineBasis& basis, RandomSplines& random) {
    const double u = random.Parameter(basis);
    const int span = basis.Span(u);
    const std::vector<double> values = Values(basis, span, u);
    const Eigen::MatrixXd derivatives = Derivatives(basis, span, u, basis.degree());
    for (int r = 0; r <= basis.degree(); ++r) EXPECT_EQ(derivatives(0, r), values[r]);
  });
}

TEST(BasisLawsTest, DerivativesSumToZero) {
  ForRandomBases([](const SplineBasis& basis, RandomSplines& random) {
    const double u = random.Parameter(basis);
    const int p = basis.degree(), span = basis.Span(u);
    const Eigen::MatrixXd derivatives = Derivatives(basis, span, u, p);
    const Sized exact = ExtendedBasis(basis, span, u, p);
    for (int k = 1; k <= p; ++k) {
      EXPECT_NEAR(derivatives.row(k).sum(),
                  0,
                  4 * p * kEpsilon * static_cast<double>(exact.size.col(k).sum()))
          << "order " << k << " at " << u;
    }
  });
}

TEST(BasisLawsTest, DerivativesAreTheLimitsOfDifferences) {
  ForRandomBases([](const SplineBasis& basis, RandomSplines& random) {
    const int p = basis.degree();
    for (const int span : basis.Spans()) {
      const double length = basis.knots()[span + 1] - basis.knots()[span];
      const double u = basis.knots()[span] + random.Real(0.2, 0.8) * length;
      const Eigen::MatrixXd exact = Derivatives(basis, span, u, p);
      // Richardson's extrapolation of central differences: error O(h⁴).
      const double h = 2e-3 * length;
      const auto central = [&](double t) -> Eigen::MatrixXd {
        return (Derivatives(basis, span, u + t, p) - Derivatives(basis, span, u - t, p)) / (2 * t);
      };
      const Eigen::MatrixXd difference = (4 * central(h / 2) - central(h)) / 3;
      for (int k = 1; k <= p; ++k) {
        const double size = std::max(exact.row(k).cwiseAbs().maxCoeff(),
                                     exact.row(k - 1).cwiseAbs().maxCoeff() / length);
        EXPECT_LE((exact.row(k) - difference.row(k - 1)).cwiseAbs().maxCoeff(), kHalfDigits * size)
            << "order " << k << " on span " << span;
      }
    }
  });
}

// N'_{i,p} = p·N_{i,p−1}/(u_{i+p} − u_i) − p·N_{i+1,p−1}/(u_{i+p+1} − u_{i+1}): the basis of one
// degree less has the same knots but for the first and the last, and its function j is N_{j+1,p−1}.
TEST(BasisLawsTest, DerivativeIsASplineOfOneDegreeLess) {
  for (int degree = 2; degree <= kHighestDegree; ++degree) {
    for (unsigned seed = 0; seed < 18; ++seed) {
      SCOPED_TRACE("degree " + std::to_string(degree) + ", seed " + std::to_string(seed));
      RandomSplines random(100 * degree + seed);
      BasisKind kind = KindOfBasis(static_cast<int>(seed) % kBasisKinds, 7);
      kind.highest_multiplicity = degree - 1;
      const SplineBasis basis = random.Basis(degree, kind);
      const std::vector<double>& U = basis.knots();
      const SplineBasis lower(degree - 1, std::vector<double>(U.begin() + 1, U.end() - 1));
      for (int trial = 0; trial < 5; ++trial) {
        const double u = random.Parameter(basis);
        const int p = degree;
        const Sized exact = ExtendedBasis(basis, basis.Span(u), u, 4);
        for (int i = 0; i < basis.size(); ++i) {
          const std::vector<double> all = basis.FunctionDerivatives(i, u, 4);
          const auto part = [&](int j, int k) {  // N_{j,p−1}^(k) over the length of its support
            if (j == 0 || j == basis.size()) return 0.0;
            return lower.FunctionDerivatives(j - 1, u, k)[k] / (U[j + p] - U[j]);
          };
          for (int k = 1; k <= 4; ++k) {
            const double left = part(i, k - 1), right = part(i + 1, k - 1);
            EXPECT_NEAR(all[k],
                        p * (left - right),
                        8 * p * kEpsilon * static_cast<double>(exact.size.col(k).maxCoeff()))
                << "N_" << i << ", order " << k << " at " << u;
          }
        }
      }
      if (HasFailure()) return;
    }
  }
}

TEST(BasisLawsTest, DerivativesAboveTheDegreeVanish) {
  ForRandomBases([](const SplineBasis& basis, RandomSplines& random) {
    const double u = random.Parameter(basis);
    const int p = basis.degree();
    EXPECT_TRUE(Derivatives(basis, basis.Span(u), u, p + 2).bottomRows(2).isZero(0));
    const std::vector<double> last = basis.FunctionDerivatives(basis.Span(u), u, p + 3);
    EXPECT_EQ(last.size(), static_cast<size_t>(p) + 4);
    EXPECT_THAT(std::vector<double>(last.end() - 3, last.end()), testing::Each(0.0));
  });
}

// Along its support a function rises, then falls: its slope changes sign once at most.
TEST(BasisLawsTest, EveryFunctionHasOneMaximum) {
  ForRandomBases([](const SplineBasis& basis, RandomSplines&) {
    const std::vector<double> parameters = Inside(basis, 12);
    for (int i = 0; i < basis.size(); ++i) {
      bool falls = false;
      for (const double u : parameters) {
        const int span = basis.Span(u), p = basis.degree();
        if (i < span - p || i > span) continue;
        const double slope = basis.FunctionDerivatives(i, u, 1)[1];
        const Sized exact = ExtendedBasis(basis, span, u, 1);
        const double rounding = 3 * p * kEpsilon * static_cast<double>(exact.size(i - span + p, 1));
        if (slope < -rounding) falls = true;
        if (slope > rounding) {
          EXPECT_FALSE(falls) << "N_" << i << " rises again at " << u;
        }
      }
    }
  });
}

// (u − t)^p = Σ N_i(u)·Π_k (u_{i+k} − t): for p + 1 values of t these are p + 1 independent
// polynomials, so that on every span the p + 1 functions are independent and reproduce all of them.
// [Marsden 1970]
TEST(BasisLawsTest, ReproducesPolynomialsSoThatTheFunctionsOfASpanAreIndependent) {
  ForRandomBases([](const SplineBasis& basis, RandomSplines& random) {
    const int p = basis.degree();
    for (const int span : basis.Spans()) {
      const double a = basis.knots()[span], b = basis.knots()[span + 1];
      const double u = random.Real(a, b);
      const std::vector<double> values = Values(basis, span, u);
      for (int k = 0; k <= p; ++k) {
        const double t = a + (b - a) * k / p;
        double sum = 0, size = 0;
        for (int r = 0; r <= p; ++r) {
          double product = values[r];
          for (int j = 1; j <= p; ++j) product *= basis.knots()[span - p + r + j] - t;
          sum += product;
          size += std::abs(product);
        }
        // Each of p factors is rounded twice, and a knot difference and u − t are rounded too.
        EXPECT_NEAR(sum, std::pow(u - t, p), 8 * p * kEpsilon * (size + std::pow(b - a, p)));
      }
    }
  });
}

// The whole basis: as many functions as independent values at Greville's abscissae. [Schoenberg &
// Whitney 1953]
TEST(BasisLawsTest, FunctionsAreLinearlyIndependent) {
  for (int degree = 1; degree <= 7; ++degree) {
    for (unsigned seed = 0; seed < 10; ++seed) {
      SCOPED_TRACE("degree " + std::to_string(degree) + ", seed " + std::to_string(seed));
      RandomSplines random(100 * degree + seed);
      const SplineBasis basis = random.Basis(degree, {.most_spans = 7});
      const int n = basis.size();
      Eigen::MatrixXd values(n, n);
      for (int i = 0; i < n; ++i) {
        for (int j = 0; j < n; ++j) values(i, j) = basis.Function(j, basis.Greville(i));
      }
      Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(values);
      qr.setThreshold(kRounding);
      EXPECT_EQ(qr.rank(), n);
    }
  }
}

TEST(BasisLawsTest, GrevilleAbscissaeReproduceTheParameter) {
  ForRandomBases([](const SplineBasis& basis, RandomSplines& random) {
    for (int trial = 0; trial < 10; ++trial) {
      const double u = random.Parameter(basis);
      const int span = basis.Span(u), p = basis.degree();
      const std::vector<double> values = Values(basis, span, u);
      double sum = 0, size = 1;
      for (int r = 0; r <= p; ++r) {
        const double abscissa = basis.Greville(span - p + r);
        sum += values[r] * abscissa;
        size = std::max(size, std::abs(abscissa));
      }
      EXPECT_NEAR(sum, u, 8 * p * kEpsilon * size);
    }
  });
}

// At a knot of multiplicity k the pieces of both sides agree in orders up to p − k, and some
// function jumps in the next.
TEST(BasisLawsTest, IsAsSmoothAtAKnotAsItsMultiplicityAllows) {
  ForRandomBases([](const SplineBasis& basis, RandomSplines&) {
    const int p = basis.degree();
    for (const double knot : InnerKnots(basis)) {
      const int after = basis.Span(knot), k = basis.Multiplicity(knot), before = after - k;
      const Eigen::MatrixXd left = Derivatives(basis, before, knot, p);
      const Eigen::MatrixXd right = Derivatives(basis, after, knot, p);
      const Sized left_size = ExtendedBasis(basis, before, knot, p);
      const Sized right_size = ExtendedBasis(basis, after, knot, p);
      for (int order = 0; order <= p - k + 1; ++order) {
        const double size = static_cast<double>(
            std::max(left_size.size.col(order).maxCoeff(), right_size.size.col(order).maxCoeff()));
        double jump = 0;
        for (int i = before - p; i <= after; ++i) {
          const double l = i <= before ? left(order, i - before + p) : 0;
          const double r = i >= after - p ? right(order, i - after + p) : 0;
          jump = std::max(jump, std::abs(l - r));
        }
        if (order <= p - k) {
          EXPECT_LE(jump, 6 * p * kEpsilon * size) << "order " << order << " at " << knot;
        } else {
          EXPECT_GT(jump, 100 * p * kEpsilon * size) << "multiplicity " << k << " at " << knot;
        }
      }
    }
  });
}

TEST(BasisLawsTest, ScalingAndShiftingTheKnotsChangesNoValue) {
  ForRandomBases([](const SplineBasis& basis, RandomSplines& random) {
    for (const double scale : {0x1p-30, 1.0, 0x1p30}) {
      // Powers of two and a shift that rounds no knot: bases of 20 bits.
      std::vector<double> coarse = basis.knots(), moved;
      for (double& knot : coarse) knot = std::round(knot * 0x1p16) * 0x1p-16;
      for (const double knot : coarse) moved.push_back(scale * (knot + 64));
      const SplineBasis here(basis.degree(), coarse), there(basis.degree(), moved);
      const double u = std::round(random.Real(here.lower(), here.upper()) * 0x1p30) * 0x1p-30;
      const int span = here.Span(u), p = basis.degree();
      EXPECT_EQ(there.Span(scale * (u + 64)), span);
      const Eigen::MatrixXd expected = Derivatives(here, span, u, p);
      const Eigen::MatrixXd actual = Derivatives(there, span, scale * (u + 64), p);
      for (int k = 0; k <= p; ++k) {
        EXPECT_EQ(actual.row(k) * std::pow(scale, k), expected.row(k)) << "order " << k;
      }
    }
  });
}

TEST(BasisLawsTest, ReversingTheKnotsReversesTheFunctions) {
  ForRandomBases([](const SplineBasis& basis, RandomSplines& random) {
    std::vector<double> knots = basis.knots();
    std::reverse(knots.begin(), knots.end());
    for (double& knot : knots) knot = -knot;
    const SplineBasis reversed(basis.degree(), knots);
    const double u = random.Real(basis.lower(), basis.upper());
    const int n = basis.size(), p = basis.degree();
    const Sized exact = ExtendedBasis(basis, basis.Span(u), u, 3);
    for (int i = 0; i < n; ++i) {
      const std::vector<double> a = basis.FunctionDerivatives(i, u, 3);
      const std::vector<double> b = reversed.FunctionDerivatives(n - 1 - i, -u, 3);
      for (int k = 0; k <= 3; ++k) {
        EXPECT_NEAR(a[k],
                    k % 2 == 0 ? b[k] : -b[k],
                    6 * p * kEpsilon * static_cast<double>(exact.size.col(k).maxCoeff()));
      }
    }
  });
}

TEST(BasisLawsTest, LawsHoldAtTheHighestDegree) {
  RandomSplines random(25);
  for (int kind = 0; kind < kBasisKinds; ++kind) {
    const SplineBasis basis = random.Basis(kMaxDegree, KindOfBasis(kind));
    for (int trial = 0; trial < 20; ++trial) {
      const double u = random.Parameter(basis);
      const int span = basis.Span(u);
      const Eigen::MatrixXd derivatives = Derivatives(basis, span, u, kMaxDegree + 1);
      const Sized exact = ExtendedBasis(basis, span, u, kMaxDegree + 1);
      EXPECT_NEAR(derivatives.row(0).sum(), 1, 4 * kMaxDegree * kEpsilon);
      EXPECT_GE(derivatives.row(0).minCoeff(), 0);
      for (int k = 0; k <= kMaxDegree + 1; ++k) {
        for (int r = 0; r <= kMaxDegree; ++r) {
          EXPECT_LE(std::abs(static_cast<double>(derivatives(k, r) - exact.value(r, k))),
                    3 * kMaxDegree * kEpsilon * static_cast<double>(exact.size(r, k)));
        }
      }
    }
  }
}

}  // namespace batten::internal::basis_laws_test
