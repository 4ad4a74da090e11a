// SPDX-License-Identifier: MIT
#include "fitting/least_squares/fairness.h"

#include <gtest/gtest.h>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "random_splines.h"
#include "tolerances.h"

namespace batten::internal::fairness_test {

// Derivatives over cells down to a twentieth long lose digits by the powers of that.
constexpr double kDerivativeRounding = 1e3 * kRounding;

double FunctionDerivative(const SplineBasis& basis, int i, int span, double u, int order) {
  const int p = basis.degree(), r = i - span + p;
  if (r < 0 || r > p) return 0;
  std::vector<double> values((order + 1) * (p + 1));
  basis.Derivatives(span, u, order, values.data());
  return values[order * (p + 1) + r];
}

// ∫ over the domain by the midpoints of many strips a span: the error falls with their square.
double NumericIntegral(const SplineBasis& basis, const std::function<double(int, double)>& f) {
  constexpr int kStrips = 400;
  double sum = 0;
  for (const int span : basis.Spans()) {
    const double a = basis.knots()[span], h = (basis.knots()[span + 1] - a) / kStrips;
    // Midpoints on two grids, extrapolated: O(h⁴).
    double fine = 0, coarse = 0;
    for (int k = 0; k < kStrips; ++k) fine += h * f(span, a + (k + 0.5) * h);
    for (int k = 0; k < kStrips / 2; ++k) coarse += 2 * h * f(span, a + (k + 0.5) * 2 * h);
    sum += fine + (fine - coarse) / 3;
  }
  return sum;
}

Eigen::VectorXd RandomVector(RandomSplines& random, Eigen::Index count) {
  Eigen::VectorXd vector(count);
  for (double& x : vector) x = random.Real(-1, 1);
  return vector;
}

// The coefficients of f(u) of degree ≤ p by interpolation at Greville abscissae.
Eigen::VectorXd Interpolate(const SplineBasis& basis, const std::function<double(double)>& f) {
  const int n = basis.size(), p = basis.degree();
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(n, n);
  Eigen::VectorXd values(n);
  std::vector<double> N(p + 1);
  for (int i = 0; i < n; ++i) {
    const double u = basis.Greville(i);
    const int span = basis.Span(u);
    basis.Values(span, u, N.data());
    for (int r = 0; r <= p; ++r) matrix(i, span - p + r) = N[r];
    values[i] = f(u);
  }
  return matrix.partialPivLu().solve(values);
}

// Coefficients of f(u)·g(v), outer index first.
Eigen::VectorXd Product(const Eigen::VectorXd& outer, const Eigen::VectorXd& inner) {
  return (inner * outer.transpose()).reshaped();
}

Eigen::MatrixXd DenseForm(
    const FairnessForm& form, int outer, int inner, int bandwidth, int reach, double weight) {
  TensorBand band(outer, inner, bandwidth, reach);
  form.AddTo(band, weight);
  const BlockBandedMatrix matrix = band.Of({0, outer, 0, inner});
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(matrix.size(), matrix.size());
  for (int row = 0; row < outer; ++row) {
    for (int below = 0; below <= std::min(row, bandwidth); ++below) {
      dense.block((row - below) * inner, row * inner, inner, inner) =
          matrix.at(row, below).transpose();
      dense.block(row * inner, (row - below) * inner, inner, inner) = matrix.at(row, below);
    }
  }
  return dense;
}

// Bases whose functions have square integrable second derivatives where the degree is 2 or more.
const BasisKind kSmooth{.most_spans = 5, .highest_multiplicity = 1};

TEST(DerivativeGramTest, HoldsTheIntegralsOfProducts) {
  for (unsigned seed = 0; seed < 30; ++seed) {
    RandomSplines random(seed);
    const int degree = random.Integer(1, 5), order = random.Integer(0, 3);
    SCOPED_TRACE("seed " + std::to_string(seed) + ", degree " + std::to_string(degree) +
                 ", order " + std::to_string(order));
    const SplineBasis basis = random.Basis(degree, {.clamped = seed % 2 == 0, .most_spans = 3});
    const Eigen::MatrixXd gram = DerivativeGram(basis, order);
    ASSERT_EQ(gram.rows(), basis.size());
    ASSERT_EQ(gram.cols(), degree + 1);
    const double size = gram.cwiseAbs().maxCoeff();
    for (int i = 0; i < basis.size(); ++i) {
      for (int a = 0; a <= degree && i + a < basis.size(); ++a) {
        const double expected = NumericIntegral(basis, [&](int span, double u) {
          return FunctionDerivative(basis, i, span, u, order) *
                 FunctionDerivative(basis, i + a, span, u, order);
        });
        EXPECT_NEAR(gram(i, a), expected, kHalfDigits * size) << "i = " << i << ", a = " << a;
      }
    }
  }
}

TEST(DerivativeGramTest, OfOrderZeroSumsToTheLengthOfTheDomain) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const SplineBasis basis = random.Basis(random.Integer(1, 11), {.clamped = random.Coin()});
    const Eigen::MatrixXd gram = DerivativeGram(basis, 0);
    const double sum = 2 * gram.sum() - gram.col(0).sum();  // the band's other half too
    EXPECT_NEAR(sum, basis.upper() - basis.lower(), kRounding * sum);
  }
}

TEST(FairnessFormTest, IsZeroForLinearFunctions) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const SplineBasis u = random.Basis(random.Integer(2, 5)),
                      v = random.Basis(random.Integer(2, 5));
    const double a = random.Real(-1, 1), b = random.Real(-1, 1), c = random.Real(-1, 1);
    Eigen::VectorXd plane(u.size() * v.size());
    for (int i = 0; i < u.size(); ++i) {
      for (int j = 0; j < v.size(); ++j)
        plane[i * v.size() + j] = a + b * u.Greville(i) + c * v.Greville(j);
    }
    const FairnessForm form(u, &v);
    EXPECT_NEAR(form.Energy(plane), 0, kDerivativeRounding * form.Trace());
  }
}

TEST(FairnessFormTest, IsTheThinPlateIntegralOfQuadratics) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const SplineBasis u = random.Basis(random.Integer(2, 5), kSmooth);
    const SplineBasis v = random.Basis(random.Integer(2, 5), kSmooth);
    const FairnessForm form(u, &v);
    const double area = (u.upper() - u.lower()) * (v.upper() - v.lower());
    const auto one = [](double) { return 1.0; };
    const auto same = [](double t) { return t; };
    const auto square = [](double t) { return t * t; };
    const double rounding = kDerivativeRounding * std::max(1.0, form.Trace());
    // (u²)_uu = 2, (uv)_uv = 1, (v²)_vv = 2.
    EXPECT_NEAR(
        form.Energy(Product(Interpolate(u, square), Interpolate(v, one))), 4 * area, rounding);
    EXPECT_NEAR(
        form.Energy(Product(Interpolate(u, same), Interpolate(v, same))), 2 * area, rounding);
    EXPECT_NEAR(
        form.Energy(Product(Interpolate(u, one), Interpolate(v, square))), 4 * area, rounding);
  }
}

TEST(FairnessFormTest, IsTheMembraneIntegralWhereADegreeIsOne) {
  for (const auto& [p, q] : {std::pair{1, 1}, {1, 3}, {4, 1}}) {
    SCOPED_TRACE("degrees " + std::to_string(p) + ", " + std::to_string(q));
    RandomSplines random(10 * p + q);
    const SplineBasis u = random.Basis(p, kSmooth), v = random.Basis(q, kSmooth);
    const FairnessForm form(u, &v);
    const double area = (u.upper() - u.lower()) * (v.upper() - v.lower());
    const auto one = [](double) { return 1.0; };
    const auto triple = [](double t) { return 3 * t; };
    const double rounding = kDerivativeRounding * form.Trace();
    EXPECT_NEAR(form.Energy(Eigen::VectorXd::Ones(u.size() * v.size())), 0, rounding);
    EXPECT_NEAR(
        form.Energy(Product(Interpolate(u, triple), Interpolate(v, one))), 9 * area, rounding);
    EXPECT_NEAR(
        form.Energy(Product(Interpolate(u, one), Interpolate(v, triple))), 9 * area, rounding);
  }
}

constexpr FairnessEnergy kEnergies[] = {
    FairnessEnergy::kMembrane, FairnessEnergy::kThinPlate, FairnessEnergy::kThirdOrder};

TEST(FairnessFormTest, DoesNotSeePolynomialsBelowItsOrder) {
  for (unsigned seed = 0; seed < 30; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const SplineBasis u = random.Basis(random.Integer(3, 5), kSmooth),
                      v = random.Basis(random.Integer(3, 5), kSmooth);
    const auto power = [](int k) { return [k](double t) { return std::pow(t, k); }; };
    for (int order = 1; order <= 3; ++order) {
      const FairnessForm form(u, &v, kEnergies[order - 1]);
      for (int k = 0; k < order; ++k) {
        for (int l = 0; k + l < order; ++l) {
          const Eigen::VectorXd net = Product(Interpolate(u, power(k)), Interpolate(v, power(l)));
          EXPECT_NEAR(form.Energy(net),
                      0,
                      kDerivativeRounding * form.Trace() * std::max(1.0, net.squaredNorm()));
        }
      }
    }
  }
}

// u^a v^b over a rectangle from the origin: each derivative is a monomial, integrated by hand.
double MonomialEnergy(int order, int a, int b, double length_u, double length_v) {
  const auto squared = [](int power, int derivative, double length) {
    if (derivative > power) return 0.0;
    double factor = 1;
    for (int k = 0; k < derivative; ++k) factor *= power - k;
    const int left = 2 * (power - derivative) + 1;
    return factor * factor * std::pow(length, left) / left;
  };
  const double binomials[4][4] = {{1, 0, 0, 0}, {1, 1, 0, 0}, {1, 2, 1, 0}, {1, 3, 3, 1}};
  double sum = 0;
  for (int k = 0; k <= order; ++k)
    sum += binomials[order][k] * squared(a, order - k, length_u) * squared(b, k, length_v);
  return sum;
}

TEST(FairnessFormTest, IsTheIntegralOfMonomials) {
  const SplineBasis u = SplineBasis::Uniform(4, 7, 0, 1.5), v = SplineBasis::Uniform(3, 6, 0, 2);
  for (int order = 1; order <= 3; ++order) {
    const FairnessForm form(u, &v, kEnergies[order - 1]);
    for (int a = 0; a <= 4; ++a) {
      for (int b = 0; b <= 3; ++b) {
        SCOPED_TRACE(std::to_string(order) + ": u^" + std::to_string(a) + " v^" +
                     std::to_string(b));
        const Eigen::VectorXd net =
            Product(Interpolate(u, [&](double t) { return std::pow(t, a); }),
                    Interpolate(v, [&](double t) { return std::pow(t, b); }));
        const double expected = MonomialEnergy(order, a, b, 1.5, 2);
        EXPECT_NEAR(form.Energy(net), expected, kDerivativeRounding * std::max(1.0, expected));
      }
    }
  }
}

TEST(FairnessFormTest, IntegratesTheDerivativesOfCurves) {
  const SplineBasis u = SplineBasis::Uniform(5, 9, 0, 2);
  for (int order = 1; order <= 3; ++order) {
    const FairnessForm form(u, nullptr, kEnergies[order - 1]);
    for (int a = 0; a <= 5; ++a) {
      const Eigen::VectorXd net = Interpolate(u, [&](double t) { return std::pow(t, a); });
      const double expected = MonomialEnergy(order, a, 0, 2, 1);
      EXPECT_NEAR(form.Energy(net), expected, kDerivativeRounding * std::max(1.0, expected));
    }
  }
}

// A cubic in directions turned by an angle: over a disc the energy could not change; over a square
// it is compared with the integral of the turned derivatives, which must be the same number
// wherever they are constant.
TEST(FairnessFormTest, DoesNotChangeWhenTheParameterPlaneIsTurned) {
  const SplineBasis u = SplineBasis::Uniform(3, 6, -1, 1), v = SplineBasis::Uniform(3, 7, -1, 1);
  for (int order = 1; order <= 3; ++order) {
    const FairnessForm form(u, &v, kEnergies[order - 1]);
    double first = 0;
    for (const double angle : {0.0, 0.3, 1.1, 2.0}) {
      // (u cos + v sin)^order: its derivatives of that order are constant.
      const double c = std::cos(angle), s = std::sin(angle);
      Eigen::VectorXd net = Eigen::VectorXd::Zero(u.size() * v.size());
      double binomial = 1;
      for (int k = 0; k <= order; ++k) {
        const Eigen::VectorXd term =
            Product(Interpolate(u, [&](double t) { return std::pow(t, order - k); }),
                    Interpolate(v, [&](double t) { return std::pow(t, k); }));
        net += binomial * std::pow(c, order - k) * std::pow(s, k) * term;
        binomial = binomial * (order - k) / (k + 1);
      }
      const double energy = form.Energy(net);
      if (angle == 0) first = energy;
      EXPECT_NEAR(energy, first, kDerivativeRounding * first) << order << " turned by " << angle;
    }
  }
}

TEST(FairnessFormTest, TakesTheNextLowerOrderWhereADegreeIsTooLow) {
  RandomSplines random(3);
  const auto same = [&](int p, int q, FairnessEnergy asked, FairnessEnergy taken) {
    const SplineBasis u = random.Basis(p, kSmooth), v = random.Basis(q, kSmooth);
    const Eigen::VectorXd net = RandomVector(random, u.size() * v.size());
    EXPECT_EQ(FairnessForm(u, &v, asked).Energy(net), FairnessForm(u, &v, taken).Energy(net));
  };
  same(2, 5, FairnessEnergy::kThirdOrder, FairnessEnergy::kThinPlate);
  same(4, 2, FairnessEnergy::kThirdOrder, FairnessEnergy::kThinPlate);
  same(1, 3, FairnessEnergy::kThirdOrder, FairnessEnergy::kMembrane);
  same(3, 1, FairnessEnergy::kThinPlate, FairnessEnergy::kMembrane);
}

TEST(FairnessFormTest, IsTheQuadraticFormOfTheMatrixItAdds) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const SplineBasis u = random.Basis(random.Integer(1, 5)),
                      v = random.Basis(random.Integer(1, 5));
    const FairnessForm form(u, &v);
    const Eigen::MatrixXd matrix = DenseForm(form, u.size(), v.size(), u.degree(), v.degree(), 1);
    const Eigen::VectorXd c = RandomVector(random, matrix.rows());
    const double scale = kRounding * matrix.cwiseAbs().sum();
    EXPECT_NEAR(form.Energy(c), c.dot(matrix * c), scale);
    EXPECT_NEAR(form.Trace(), matrix.trace(), scale);
    EXPECT_LE((matrix - matrix.transpose()).cwiseAbs().maxCoeff(), scale);
  }
}

TEST(FairnessFormTest, AddsInProportionToItsWeight) {
  RandomSplines random(1);
  const SplineBasis u = random.Basis(3), v = random.Basis(2);
  const FairnessForm form(u, &v);
  const Eigen::MatrixXd once = DenseForm(form, u.size(), v.size(), 3, 2, 1);
  const Eigen::MatrixXd half = DenseForm(form, u.size(), v.size(), 3, 2, 0.5);
  EXPECT_LE((half - 0.5 * once).cwiseAbs().maxCoeff(), kRounding * once.cwiseAbs().maxCoeff());
}

TEST(FairnessFormTest, IsNeverNegative) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const SplineBasis u = random.Basis(random.Integer(1, 5)),
                      v = random.Basis(random.Integer(1, 5));
    EXPECT_GE(FairnessForm(u, &v).Energy(RandomVector(random, u.size() * v.size())), 0);
  }
}

TEST(FairnessFormTest, DoesNotDependOnWhichDirectionIsOutside) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const SplineBasis u = random.Basis(random.Integer(1, 5)),
                      v = random.Basis(random.Integer(1, 5));
    const Eigen::VectorXd c = RandomVector(random, u.size() * v.size());
    const Eigen::VectorXd turned = c.reshaped(v.size(), u.size()).transpose().reshaped();
    const double energy = FairnessForm(u, &v).Energy(c);
    EXPECT_NEAR(
        FairnessForm(v, &u).Energy(turned), energy, kRounding * FairnessForm(u, &v).Trace());
  }
}

}  // namespace batten::internal::fairness_test
