// SPDX-License-Identifier: MIT
#include "fitting/knots/data_knots.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <stdexcept>
#include <string>
#include <vector>

#include "batten/geometry/knot_vectors.h"
#include "random_splines.h"
#include "tolerances.h"

namespace batten::internal::data_knots_test {

TEST(DataKnotsTest, KnotsAroundGoRoundWithTheData) {
  for (unsigned seed = 1; seed <= 300; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const int degree = random.Integer(1, 8), count = random.Integer(1, 20);
    std::vector<double> t(1, random.Real(-3, 3));
    for (int k = 0; k < count; ++k) {
      const bool twice = degree > 2 && k > 0 && k + 1 < count && t[k] > t[std::max(0, k - 1)] &&
                         random.Integer(0, 4) == 0;
      t.push_back(t.back() + (twice ? 0 : random.Logarithmic(1e-3, 1)));
    }
    const ClosedKnots knots = KnotsAround(degree, t);
    EXPECT_TRUE(knots.basis.periodic());
    EXPECT_EQ(knots.basis.size() - degree, count);
    EXPECT_EQ(knots.basis.lower(), t.front());
    EXPECT_NEAR(knots.basis.upper(), t.back(), kRounding * 10);
    ASSERT_EQ(knots.parameters.size(), count);
    for (int k = 0; k < count; ++k) {
      EXPECT_GE(knots.parameters[k], knots.basis.lower());
      EXPECT_LT(knots.parameters[k], knots.basis.upper());
      // All moved alike, going round.
      const double moved = (knots.parameters[k] - knots.parameters[0]) - (t[k] - t[0]);
      EXPECT_NEAR(moved < -kHalfDigits ? moved + (t.back() - t.front()) : moved, 0, kRounding * 20);
    }
  }
}

// Brute force: the interpolation matrix of random parameters is regular exactly where no function
// lacks a parameter.
TEST(DataKnotsTest, TheSchoenbergWhitneyConditionTellsRegularMatrices) {
  int regular = 0;
  for (unsigned seed = 1; seed <= 500; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const int degree = random.Integer(1, 4);
    const SplineBasis basis =
        random.Basis(degree, {.clamped = random.Coin(), .highest_multiplicity = 1});
    std::vector<double> t(basis.size());
    for (double& u : t) u = random.Parameter(basis);
    std::sort(t.begin(), t.end());
    t.erase(std::unique(t.begin(), t.end()), t.end());
    if (static_cast<int>(t.size()) < basis.size()) continue;
    Eigen::MatrixXd matrix(basis.size(), basis.size());
    for (int k = 0; k < basis.size(); ++k) {
      for (int i = 0; i < basis.size(); ++i) matrix(k, i) = basis.Function(i, t[k]);
    }
    const bool singular = FirstUnsupported(basis, t).has_value();
    const Eigen::VectorXd values = matrix.jacobiSvd().singularValues();
    regular += !singular;
    // Nearly unsupported functions are as small as the distance to the power of the degree.
    if (singular) {
      EXPECT_LE(values.minCoeff(), kRounding * values[0]);
    } else {
      EXPECT_GT(values.minCoeff(), 0);
    }
  }
  EXPECT_GT(regular, 50);
}

TEST(DataKnotsTest, AveragedAndLeastSquaresKnotsSuitTheirParameters) {
  for (unsigned seed = 1; seed <= 200; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const int degree = random.Integer(1, 6), count = random.Integer(degree + 1, 40);
    std::vector<double> t;
    for (double u = 0; static_cast<int>(t.size()) < count; u += random.Logarithmic(1e-4, 1)) {
      t.push_back(u);
    }
    EXPECT_EQ(FirstUnsupported(AveragedKnots(degree, t), t), std::nullopt);
    const int size = random.Integer(degree + 1, count);
    EXPECT_EQ(FirstUnsupported(LeastSquaresKnots(degree, size, t), t), std::nullopt);
    EXPECT_EQ(FirstUnsupported(DensityKnots(degree, size, t), t), std::nullopt);
  }
}

TEST(DataKnotsTest, KnotsAroundRefuseWhatIsNotAClosedRow) {
  const auto knots = [](int degree, std::vector<double> t) { return KnotsAround(degree, t); };
  EXPECT_THROW(knots(0, {0, 1, 2}), std::invalid_argument);
  EXPECT_THROW(knots(26, {0, 1, 2}), std::invalid_argument);
  EXPECT_THROW(knots(3, {0}), std::invalid_argument);
  EXPECT_THROW(knots(3, {0, 2, 1}), std::invalid_argument);
  EXPECT_THROW(knots(3, {1, 1, 1}), std::invalid_argument);
}

}  // namespace batten::internal::data_knots_test
