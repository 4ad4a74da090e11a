// SPDX-License-Identifier: MIT
// Periodic bases, curves and surfaces: nothing tells where the period begins. [Piegl & Tiller 1997,
// §12.2]
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"
#include "extended_evaluation.h"
#include "random_splines.h"

namespace batten::internal::periodic_test {

constexpr int kHighestDegree = 11;

// A periodic basis whose knots are multiples of 2^-10, so that adding periods rounds nothing, with
// knots of every multiplicity up to the degree.
SplineBasis DyadicBasis(int degree, RandomSplines& random) {
  std::vector<double> round;
  double knot = random.Integer(-2000, 2000) * 0x1p-10;
  for (int breaks = random.Integer(1, 6); breaks > 0; --breaks) {
    round.insert(round.end(), random.Integer(1, degree), knot);
    knot += random.Integer(1, 1000) * 0x1p-10;
  }
  const double period = knot - round.front();
  const int distinct = static_cast<int>(round.size()), start = random.Integer(0, distinct - 1);
  std::vector<double> knots;
  for (int i = start; i < start + distinct + 2 * degree + 1; ++i) {
    knots.push_back(round[i % distinct] + period * (i / distinct));
  }
  return SplineBasis::Periodic(degree, std::move(knots));
}

int Distinct(const SplineBasis& basis) { return basis.size() - basis.degree(); }
double Period(const SplineBasis& basis) { return basis.upper() - basis.lower(); }

// A parameter of 20 bits more than the knots.
double DyadicParameter(const SplineBasis& basis, RandomSplines& random) {
  return std::round(random.Real(basis.lower(), basis.upper()) * 0x1p30) * 0x1p-30;
}

// `points` round a period; the first `degree` again at the end.
Eigen::MatrixXd GoingRound(const Eigen::MatrixXd& points, Eigen::Index size) {
  Eigen::MatrixXd all(points.rows(), size);
  for (Eigen::Index i = 0; i < size; ++i) all.col(i) = points.col(i % points.cols());
  return all;
}

NurbsCurve<3> RandomCurve(const SplineBasis& basis, bool rational, RandomSplines& random) {
  Eigen::Matrix3Xd points(3, Distinct(basis));
  for (double& x : points.reshaped()) x = random.Real(-1, 1);
  Eigen::RowVectorXd weights = Eigen::RowVectorXd::Ones(points.cols());
  if (rational) weights = random.Weights(points.cols()).transpose();
  return NurbsCurve<3>(
      basis, GoingRound(points, basis.size()), GoingRound(weights, basis.size()).transpose());
}

// Calls law(curve, random).
template <typename Law>
void ForPeriodicCurves(const Law& law) {
  for (int degree = 1; degree <= kHighestDegree; ++degree) {
    for (unsigned seed = 0; seed < 12; ++seed) {
      SCOPED_TRACE("degree " + std::to_string(degree) + ", seed " + std::to_string(seed));
      RandomSplines random(100 * degree + seed);
      const SplineBasis basis = DyadicBasis(degree, random);
      law(RandomCurve(basis, seed % 2 == 1, random), random);
      if (testing::Test::HasFailure()) return;
    }
  }
}

TEST(PeriodicTest, ParametersWholePeriodsApartAreTheSame) {
  ForPeriodicCurves([](const NurbsCurve<3>& curve, RandomSplines& random) {
    const SplineBasis& basis = curve.basis();
    for (int trial = 0; trial < 20; ++trial) {
      const double u = DyadicParameter(basis, random);
      if (u == basis.upper()) continue;  // it stands for the end of its own span
      for (const int turns : {-1000, -3, -1, 1, 2, 5000}) {
        const double there = u + turns * Period(basis);
        EXPECT_EQ(basis.Clamp(there), u);
        EXPECT_EQ(curve.At(there), curve.At(u));
        EXPECT_EQ(curve.JetAt(there).second, curve.JetAt(u).second);
        EXPECT_EQ(curve.Derivatives(there, 3), curve.Derivatives(u, 3));
      }
    }
    // Outside the domain its ends are the lower one.
    EXPECT_EQ(basis.Clamp(basis.upper()), basis.upper());
    EXPECT_EQ(basis.Clamp(basis.upper() + Period(basis)), basis.lower());
    EXPECT_EQ(basis.Clamp(basis.lower() - 7 * Period(basis)), basis.lower());
  });
}

TEST(PeriodicTest, EveryFiniteParameterHasAPlaceInTheDomain) {
  ForPeriodicCurves([](const NurbsCurve<3>& curve, RandomSplines& random) {
    const SplineBasis& basis = curve.basis();
    const double largest = std::numeric_limits<double>::max();
    std::vector<double> parameters{largest, -largest, 1e17, -1e17, 1e300, -5e-324};
    parameters.push_back(std::nextafter(basis.lower(), -largest));
    parameters.push_back(std::nextafter(basis.upper(), largest));
    for (int k = 0; k < 50; ++k) {
      parameters.push_back((random.Coin() ? 1 : -1) * random.Logarithmic(1e-300, 1e300));
    }
    for (const double u : parameters) {
      const double place = basis.Clamp(u);
      EXPECT_GE(place, basis.lower()) << u;
      EXPECT_LT(place, basis.upper()) << u;
      EXPECT_EQ(basis.Clamp(place), place) << u;
      EXPECT_TRUE(curve.At(u).allFinite()) << u;
      // Whole periods away: exactly, but for the rounding of the place itself.
      if (std::abs(u) > 1e15) continue;
      const long double turns = (static_cast<long double>(u) - place) / Period(basis);
      const long double rounding = std::abs(basis.lower()) + Period(basis);
      EXPECT_NEAR(
          static_cast<double>((turns - std::round(turns)) * Period(basis)),
          0,
          2 * kEpsilon * static_cast<double>(rounding) +
              std::abs(u) * static_cast<double>(std::numeric_limits<long double>::epsilon()))
          << u;
    }
  });
}

TEST(PeriodicTest, InfinityAndNoNumberHaveNoPlace) {
  ForPeriodicCurves([](const NurbsCurve<3>& curve, RandomSplines&) {
    const double infinity = std::numeric_limits<double>::infinity();
    for (const double u : {infinity, -infinity, std::numeric_limits<double>::quiet_NaN()}) {
      EXPECT_THROW(curve.basis().Clamp(u), std::invalid_argument);
      EXPECT_THROW(curve.At(u), std::invalid_argument);
      EXPECT_THROW(curve.JetAt(u), std::invalid_argument);
      EXPECT_THROW(curve.Derivatives(u, 1), std::invalid_argument);
    }
  });
}

// How often the seam's knot is repeated: both ends of the domain stand for it.
int SeamMultiplicity(const SplineBasis& basis) {
  int multiplicity = 0;
  const std::vector<double>& U = basis.knots();
  for (int i = 0; i < Distinct(basis); ++i) {
    const double turns = (U[i + basis.degree()] - basis.lower()) / Period(basis);
    if (turns == std::round(turns)) ++multiplicity;
  }
  return multiplicity;
}

// The last p functions continue the first p: N_i + N_{i+m} is smooth across the seam.
TEST(PeriodicTest, FunctionsContinueAcrossTheSeam) {
  ForPeriodicCurves([](const NurbsCurve<3>& curve, RandomSplines&) {
    const SplineBasis& basis = curve.basis();
    const int p = basis.degree(), m = Distinct(basis), k = SeamMultiplicity(basis);
    Eigen::MatrixXd start = Eigen::MatrixXd::Zero(m, p + 1), end = start;
    for (int i = 0; i < basis.size(); ++i) {
      const auto at_start = basis.FunctionDerivatives(i, basis.lower(), p);
      const auto at_end = basis.FunctionDerivatives(i, basis.upper(), p);
      for (int order = 0; order <= p; ++order) {
        start(i % m, order) += at_start[order];
        end(i % m, order) += at_end[order];
      }
    }
    const Sized low = ExtendedBasis(basis, basis.Span(basis.lower()), basis.lower(), p);
    const Sized high = ExtendedBasis(basis, basis.Span(basis.upper()), basis.upper(), p);
    for (int order = 0; order <= p - k; ++order) {
      const double size =
          static_cast<double>(low.size.col(order).sum() + high.size.col(order).sum());
      EXPECT_LE((start - end).col(order).cwiseAbs().maxCoeff(), 4 * p * kEpsilon * size)
          << "order " << order;
    }
  });
}

// C^(p−k) at a seam of multiplicity k, and no more in general.
TEST(PeriodicTest, CurvesAreAsSmoothAcrossTheSeamAsItsKnotAllows) {
  ForPeriodicCurves([](const NurbsCurve<3>& curve, RandomSplines&) {
    const SplineBasis& basis = curve.basis();
    const int p = basis.degree(), k = SeamMultiplicity(basis);
    const auto start = curve.Derivatives(basis.lower(), p),
               end = curve.Derivatives(basis.upper(), p);
    const Eigen::Vector3d zero = Eigen::Vector3d::Zero();
    const Sized low = ExtendedCurve(curve, basis.lower(), p, zero);
    const Sized high = ExtendedCurve(curve, basis.upper(), p, zero);
    for (int order = 0; order <= p - k + 1; ++order) {
      const double size =
          static_cast<double>(low.size.col(order).maxCoeff() + high.size.col(order).maxCoeff());
      const double jump = (start - end).col(order).cwiseAbs().maxCoeff();
      const double rounding = (order + 1) * (7 * p + order + 4) * kEpsilon * size;
      if (order <= p - k) {
        EXPECT_LE(jump, 2 * rounding) << "order " << order;
      } else if (Distinct(basis) > 1 && p <= 5) {  // above, a jump may drown in the rounding
        EXPECT_GT(jump, rounding) << "order " << order;
      }
    }
  });
}

TEST(PeriodicTest, ThePeriodMayBeginAtAnyKnot) {
  ForPeriodicCurves([](const NurbsCurve<3>& curve, RandomSplines& random) {
    const SplineBasis& basis = curve.basis();
    const int m = Distinct(basis), shift = random.Integer(1, m);
    std::vector<double> knots;
    for (int i = 0; i < m + 2 * basis.degree() + 1; ++i) {
      const int k = i + shift;  // past the end, one period back
      knots.push_back(k < std::ssize(basis.knots()) ? basis.knots()[k]
                                                    : basis.knots()[k - m] + Period(basis));
    }
    Eigen::Matrix3Xd points(3, m);
    Eigen::RowVectorXd weights(m);
    for (int i = 0; i < m; ++i) {
      points.col(i) = curve.control_points().col((i + shift) % m);
      weights[i] = curve.weights()[(i + shift) % m];
    }
    const NurbsCurve<3> turned(SplineBasis::Periodic(basis.degree(), knots),
                               GoingRound(points, basis.size()),
                               GoingRound(weights, basis.size()).transpose());
    for (int trial = 0; trial < 20; ++trial) {
      const double u = DyadicParameter(basis, random);
      EXPECT_NEAR((turned.At(u) - curve.At(u)).cwiseAbs().maxCoeff(),
                  0,
                  2 * (14 * basis.degree() + 8) * kEpsilon);
    }
  });
}

TEST(PeriodicTest, SurfacesWrapAndCloseInTheDirectionsThatArePeriodic) {
  for (unsigned seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const int p = random.Integer(1, 6), q = random.Integer(1, 6);
    const bool rational = seed % 2 == 1, both = seed % 3 == 0;
    const SplineBasis round = DyadicBasis(p, random);
    const SplineBasis across = both ? DyadicBasis(q, random) : random.Basis(q);
    const int m = Distinct(round), n = both ? Distinct(across) : across.size();
    Eigen::Matrix4Xd few(4, m * n);  // points and weight
    for (double& x : few.reshaped()) x = random.Real(-1, 1);
    few.row(3) =
        rational ? random.Weights(m * n).transpose().eval() : Eigen::RowVectorXd::Ones(m * n);
    const auto net = [&](bool swapped) {
      const SplineBasis &a = swapped ? across : round, &b = swapped ? round : across;
      Eigen::Matrix4Xd all(4, a.size() * b.size());
      for (int i = 0; i < a.size(); ++i) {
        for (int j = 0; j < b.size(); ++j) {
          const int k = swapped ? j : i, l = swapped ? i : j;
          all.col(i * b.size() + j) = few.col(k % m * n + l % n);
        }
      }
      return NurbsSurface(a, b, all.topRows<3>(), all.row(3).transpose());
    };
    const NurbsSurface surface = net(false), swapped = net(true);
    const double u = DyadicParameter(round, random), v = random.Parameter(across);
    const double infinity = std::numeric_limits<double>::infinity();
    if (u < round.upper()) {
      for (const int turns : {-2, 1, 900}) {
        const double there = u + turns * Period(round);
        EXPECT_EQ(surface.At(there, v), surface.At(u, v));
        EXPECT_EQ(swapped.At(v, there), swapped.At(v, u));
        EXPECT_EQ(surface.JetAt(there, v).duv, surface.JetAt(u, v).duv);
        EXPECT_EQ(surface.Derivatives(there, v, 3)(1, 2), surface.Derivatives(u, v, 3)(1, 2));
      }
    }
    EXPECT_THROW(surface.At(infinity, v), std::invalid_argument);
    EXPECT_THROW(swapped.JetAt(v, -infinity), std::invalid_argument);
    if (!both) {
      EXPECT_EQ(surface.At(u, infinity), surface.At(u, across.upper()));
      EXPECT_EQ(swapped.At(-infinity, u), swapped.At(across.lower(), u));
    }
    const int order = p - SeamMultiplicity(round);
    const SurfaceDerivatives start = surface.Derivatives(round.lower(), v, order + 1);
    const SurfaceDerivatives end = surface.Derivatives(round.upper(), v, order + 1);
    const Eigen::Vector3d zero = Eigen::Vector3d::Zero();
    const Sized low = ExtendedSurface(surface, round.lower(), v, order + 1, zero);
    const Sized high = ExtendedSurface(surface, round.upper(), v, order + 1, zero);
    for (int k = 0; k <= order; ++k) {
      for (int l = 0; l <= 1; ++l) {
        const Eigen::Index column = k * (order + 2) + l;
        const double size =
            static_cast<double>(low.size.col(column).maxCoeff() + high.size.col(column).maxCoeff());
        EXPECT_LE((start(k, l) - end(k, l)).cwiseAbs().maxCoeff(),
                  2 * (k + l + 1) * (7 * p + 7 * q + k + l + 6) * kEpsilon * size)
            << k << ", " << l;
      }
    }
  }
}

TEST(PeriodicTest, BasesThatDoNotRepeatAreRefused) {
  const auto refusal = [](int degree, std::vector<double> knots) -> std::string {
    try {
      SplineBasis::Periodic(degree, std::move(knots));
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_EQ(refusal(2, {-2, -1, 0, 1, 2, 3, 4}), "accepted");
  EXPECT_EQ(refusal(1, {-1, 0, 1, 2}), "accepted");
  EXPECT_THAT(refusal(2, {-2.5, -1, 0, 1, 2, 3, 4}), testing::HasSubstr("not one period 2 apart"));
  EXPECT_THAT(refusal(2, {0, 0, 0, 1, 1, 1}), testing::HasSubstr("not one period 1 apart"));
  EXPECT_THAT(refusal(2, {-2, -1, 0, 1, 2, 3, 4 + 1e-9}), testing::HasSubstr("not one period"));
  EXPECT_THAT(refusal(0, {0, 1}), testing::HasSubstr("degree 0"));
  EXPECT_THAT(refusal(1, {-1e308, 0, 1, 1e308}), testing::HasSubstr("farther apart"));
  EXPECT_THAT(refusal(1, {0, std::nan(""), 1, 1}), testing::HasSubstr("not finite"));
}

TEST(PeriodicTest, ControlPointsAndWeightsThatDoNotRepeatAreRefused) {
  RandomSplines random(3);
  const NurbsCurve<3> curve =
      RandomCurve(SplineBasis::Periodic(2, {-2, -1, 0, 1, 2, 3, 4}), true, random);
  Eigen::Matrix3Xd points = curve.control_points();
  points(2, 3) += 1e-15;
  EXPECT_THROW(NurbsCurve<3>(curve.basis(), points, curve.weights()), std::invalid_argument);
  Eigen::VectorXd weights = curve.weights();
  weights[0] *= 2;
  EXPECT_THROW(NurbsCurve<3>(curve.basis(), curve.control_points(), weights),
               std::invalid_argument);
  const NurbsSurface surface = random.Surface(2, 3, true, {.periodic = true}, {.periodic = true});
  for (const Eigen::Index column : {Eigen::Index{0}, surface.control_points().cols() - 1}) {
    Eigen::Matrix3Xd net = surface.control_points();
    net(1, column) += 0.5;
    EXPECT_THROW(NurbsSurface(surface.basis_u(), surface.basis_v(), net, surface.weights()),
                 std::invalid_argument);
    Eigen::VectorXd net_weights = surface.weights();
    net_weights[column] += 0.5;
    EXPECT_THROW(
        NurbsSurface(surface.basis_u(), surface.basis_v(), surface.control_points(), net_weights),
        std::invalid_argument);
  }
}

}  // namespace batten::internal::periodic_test
