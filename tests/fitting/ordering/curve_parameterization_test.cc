// SPDX-License-Identifier: MIT
#include "batten/fitting/curve_parameterization.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <stdexcept>
#include <string>

#include "batten/geometry/knot_vectors.h"
#include "random_splines.h"
#include "tolerances.h"

namespace batten::internal::curve_parameterization_test {

using testing::HasSubstr;

constexpr CurveParameterization kAll[] = {CurveParameterization::kUniform,
                                          CurveParameterization::kChord,
                                          CurveParameterization::kCentripetal,
                                          CurveParameterization::kFoley,
                                          CurveParameterization::kUniversal};

Eigen::MatrixXd Walk(RandomSplines& random, int dimension, int count) {
  Eigen::MatrixXd points(dimension, count);
  for (int k = 0; k < count; ++k) {
    points.col(k) = random.Vector(1).head(dimension);
    if (k > 0) points.col(k) += points.col(k - 1);
  }
  return points;
}

double Difference(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  return (a - b).cwiseAbs().maxCoeff();
}

TEST(CurveParameterizationTest, ParametersIncreaseFromZeroToOne) {
  for (unsigned seed = 1; seed <= 100; ++seed) {
    RandomSplines random(seed);
    const int count = random.Integer(2, 40), dimension = random.Integer(1, 3);
    const int degree = random.Integer(1, count - 1);
    const Eigen::MatrixXd points = Walk(random, dimension, count);
    for (const CurveParameterization kind : kAll) {
      for (const bool closed : {false, true}) {
        SCOPED_TRACE(std::string(Name(kind)) + ", seed " + std::to_string(seed));
        const Eigen::VectorXd u = CurveParameters(points, kind, std::min(degree, 25), closed);
        ASSERT_EQ(u.size(), count + (closed ? 1 : 0));
        EXPECT_EQ(u[0], 0);
        EXPECT_EQ(u[u.size() - 1], 1);
        for (Eigen::Index k = 1; k < u.size(); ++k) EXPECT_GT(u[k], u[k - 1]);
      }
    }
  }
}

TEST(CurveParameterizationTest, PlaceTurnAndSizeOfThePointsDoNotMatter) {
  for (unsigned seed = 1; seed <= 50; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const Eigen::MatrixXd points = Walk(random, 3, random.Integer(5, 30));
    const double scale = random.Logarithmic(1e-150, 1e150);
    const Eigen::MatrixXd moved =
        scale * ((random.Orthogonal() * points).colwise() + random.Vector(1)).eval();
    for (const CurveParameterization kind : kAll) {
      for (const bool closed : {false, true}) {
        SCOPED_TRACE(Name(kind));
        // Angles of small steps lose what the steps lose in the sums: some hundred roundings.
        EXPECT_LE(Difference(CurveParameters(points, kind, 3, closed),
                             CurveParameters(moved, kind, 3, closed)),
                  kRounding);
      }
    }
  }
}

TEST(CurveParameterizationTest, AffineMapsChangeNothingOfFoley) {
  for (unsigned seed = 1; seed <= 50; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const int dimension = random.Integer(2, 3);
    const Eigen::MatrixXd points = Walk(random, dimension, random.Integer(6, 30));
    Eigen::MatrixXd map = random.Orthogonal().topLeftCorner(dimension, dimension);
    map.diagonal().array() += 1.5;
    map.row(0) *= random.Logarithmic(1e-3, 1e3);
    for (const bool closed : {false, true}) {
      const auto kind = CurveParameterization::kFoley;
      // The map stretches by at most 1e3, and its inverse loses as many roundings.
      EXPECT_LE(Difference(CurveParameters(points, kind, 3, closed),
                           CurveParameters(map * points, kind, 3, closed)),
                1e3 * kRounding);
    }
  }
}

TEST(CurveParameterizationTest, FoleyOfPointsOnALineIsChordLength) {
  RandomSplines random(1);
  Eigen::MatrixXd points(3, 10);
  double along = 0;
  for (int k = 0; k < 10; ++k) {
    points.col(k) = Eigen::Vector3d(1e6, 2, 3) + along * Eigen::Vector3d(1, -2, 0.5).normalized();
    along += random.Real(0.1, 1);
  }
  // The place far away leaves ten digits of the steps.
  EXPECT_LE(Difference(CurveParameters(points, CurveParameterization::kFoley),
                       CurveParameters(points, CurveParameterization::kChord)),
            1e-8);
}

TEST(CurveParameterizationTest, FoleyGivesLongerStepsBesideATurn) {
  // Equal sides with one right angle in the middle: both sides there become longer.
  const Eigen::MatrixXd points{{0, 1, 2, 2, 2}, {0, 0, 0, 1, 2}};
  const Eigen::VectorXd u = CurveParameters(points, CurveParameterization::kFoley);
  EXPECT_GT(u[2] - u[1], 1.3 * (u[1] - u[0]));
  EXPECT_NEAR(u[2], 0.5, kRounding);
}

TEST(CurveParameterizationTest, UniversalParametersAreMaximaOfTheUniformFunctions) {
  for (int degree = 1; degree <= 9; ++degree) {
    for (int count = degree + 1; count < degree + 12; ++count) {
      const Eigen::VectorXd u = CurveParameters(
          Eigen::MatrixXd::Random(2, count), CurveParameterization::kUniversal, degree);
      const SplineBasis basis = QuasiUniformKnots(degree, count, 0, 1);
      for (int i = 0; i < count; ++i) {
        SCOPED_TRACE("degree " + std::to_string(degree) + ", function " + std::to_string(i));
        const double most = basis.Function(i, u[i]);
        for (int k = 0; k <= 400; ++k) EXPECT_LE(basis.Function(i, k / 400.0), most + kRounding);
      }
    }
  }
}

TEST(CurveParameterizationTest, RepeatedNeighboursHaveEqualParameters) {
  const Eigen::MatrixXd points{{0, 0, 1, 1, 1, 3, 3}, {0, 0, 0, 0, 0, 4, 4}};
  for (const CurveParameterization kind : {CurveParameterization::kChord,
                                           CurveParameterization::kCentripetal,
                                           CurveParameterization::kFoley}) {
    SCOPED_TRACE(Name(kind));
    for (const bool closed : {false, true}) {
      const Eigen::VectorXd u = CurveParameters(points, kind, 3, closed);
      EXPECT_EQ(u[0], u[1]);
      EXPECT_EQ(u[2], u[4]);
      EXPECT_EQ(u[5], u[6]);
      EXPECT_LT(u[1], u[2]);
      EXPECT_LT(u[4], u[5]);
      EXPECT_TRUE(u.allFinite());
    }
  }
}

TEST(CurveParameterizationTest, SaysWhatItCannotDo) {
  const auto error = [](const Eigen::MatrixXd& points, CurveParameterization kind, int degree) {
    try {
      CurveParameters(points, kind, degree);
    } catch (const std::invalid_argument& e) {
      return std::string(e.what());
    }
    return std::string("none");
  };
  EXPECT_THAT(error(Eigen::MatrixXd::Zero(2, 1), CurveParameterization::kChord, 3),
              HasSubstr("at least 2 points"));
  EXPECT_THAT(error(Eigen::MatrixXd::Ones(2, 4), CurveParameterization::kFoley, 3),
              HasSubstr("one place"));
  EXPECT_THAT(error(Eigen::MatrixXd::Random(2, 3), CurveParameterization::kUniversal, 3),
              HasSubstr("more than 3 points"));
  EXPECT_THAT(error(Eigen::MatrixXd::Random(2, 3), CurveParameterization::kGiven, 3),
              HasSubstr("kGiven"));
}

}  // namespace batten::internal::curve_parameterization_test
