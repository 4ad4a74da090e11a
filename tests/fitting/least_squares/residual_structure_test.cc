// SPDX-License-Identifier: MIT
#include "fitting/least_squares/residual_structure.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include "tolerances.h"

namespace batten::internal::residual_structure_test {

using std::numbers::pi;

constexpr double kLength = 3, kWidth = 2;
constexpr double kLayersAbove = 0.1;  // of this share the points are two sheets

using Shape = std::function<double(double, double)>;

// Scattered over a rectangle: a shape and normal noise.
SurfaceResiduals Scattered(Eigen::Index count, const Shape& shape, double sigma, unsigned seed) {
  std::mt19937_64 engine(seed);
  std::uniform_real_distribution<double> uniform;
  std::normal_distribution<double> normal;
  SurfaceResiduals given{Eigen::Matrix2Xd(2, count), Eigen::VectorXd(count)};
  for (Eigen::Index k = 0; k < count; ++k) {
    given.parameters.col(k) << kLength * uniform(engine), kWidth * uniform(engine);
    given.residuals[k] =
        shape(given.parameters(0, k), given.parameters(1, k)) + sigma * normal(engine);
  }
  return given;
}

double Nothing(double, double) { return 0; }

// The side of a square that one of so many points or cells has to itself.
double Side(double count) { return std::sqrt(kLength * kWidth / count); }

// Waves both ways; the root of the mean square is a half.
Shape Waves(double length) {
  return [=](double u, double v) {
    return std::sin(2 * pi * u / length) * std::cos(2 * pi * v / length);
  };
}

SurfaceResiduals Shuffled(const SurfaceResiduals& given, unsigned seed) {
  std::vector<Eigen::Index> order(static_cast<size_t>(given.residuals.size()));
  std::iota(order.begin(), order.end(), 0);
  std::shuffle(order.begin(), order.end(), std::mt19937_64(seed));
  return {given.parameters(Eigen::all, order), given.residuals(order), given.seed};
}

double Structured(const SurfaceResiduals& given, int control_points, int threads = 2) {
  ThreadPool pool(threads);
  return StructuredShare(given, control_points, pool);
}

double Layered(const SurfaceResiduals& given, int threads = 2) {
  ThreadPool pool(threads);
  return DoubleLayerFractionOf(given, pool);
}

TEST(StructuredShareTest, IsAboutZeroOfWhiteNoiseHoweverManyPoints) {
  for (const Eigen::Index count : {500, 5000, 40000}) {
    for (const int control_points : {16, 100, 400}) {
      for (const double sigma : {1e-6, 1e-2}) {
        SCOPED_TRACE(std::to_string(count) + " points, " + std::to_string(control_points) +
                     " control points, sigma " + std::to_string(sigma));
        // Six coefficients explain six points' worth of noise in 24 or more, which the freedom left
        // pays back; of that, chance leaves √12 / 24 a place, over 20 places or more apart.
        EXPECT_NEAR(Structured(Scattered(count, Nothing, sigma, 1), control_points), 0, 0.08);
      }
    }
  }
}

TEST(StructuredShareTest, IsAboutOneOfWhatIsSmoothOverACell) {
  for (const Eigen::Index count : {3000, 30000}) {
    for (const int control_points : {30, 60}) {
      SCOPED_TRACE(std::to_string(count) + " points, " + std::to_string(control_points) +
                   " control points");
      const SurfaceResiduals given = Scattered(count, Waves(2 * Side(control_points)), 0, 2);
      EXPECT_GT(Structured(given, control_points), 0.97);
    }
  }
}

TEST(StructuredShareTest, IsTheShareOfTheVarianceThatIsSmooth) {
  for (const double sigma : {0.25, 0.5, 1.0, 2.0}) {
    SCOPED_TRACE("sigma " + std::to_string(sigma));
    const SurfaceResiduals given = Scattered(20000, Waves(3 * Side(60)), sigma, 3);
    // The waves' mean square is 1/4. Over 400 places of 166 points the sums are right to a percent
    // or two.
    EXPECT_NEAR(Structured(given, 60), 0.25 / (0.25 + sigma * sigma), 0.04);
  }
}

TEST(StructuredShareTest, PassesOverWhatASmallPartOfACellShares) {
  // Squares of four points each share half of the variance: as good as noise of a quarter of the
  // points, of which a quadric in 240 explains 6 in 60.
  std::mt19937_64 engine(4);
  std::normal_distribution<double> normal;
  SurfaceResiduals given = Scattered(20000, Nothing, 1, 4);
  const double side = Side(5000);
  std::vector<double> shared(200 * 200);
  for (double& x : shared) x = normal(engine);
  for (Eigen::Index k = 0; k < given.residuals.size(); ++k) {
    const Eigen::Vector2d place = given.parameters.col(k) / side;
    given.residuals[k] +=
        shared[static_cast<size_t>(place[0]) * 200 + static_cast<size_t>(place[1])];
  }
  EXPECT_LT(std::abs(Structured(given, 30)), 0.1);
}

TEST(StructuredShareTest, DoesNotDependOnUnitsMotionsSignOrOrder) {
  const SurfaceResiduals given = Scattered(4000, Waves(3 * Side(60)), 0.5, 5);
  const double share = Structured(given, 60);
  for (const double factor : {1e-9, 1e-3, -1.0, 30.0, 1e6}) {
    SCOPED_TRACE("factor " + std::to_string(factor));
    EXPECT_NEAR(
        Structured({given.parameters, factor * given.residuals, given.seed}, 60), share, kIterated);
  }
  for (const double unit : {1e-6, 1e6}) {
    SCOPED_TRACE("unit " + std::to_string(unit));
    EXPECT_NEAR(Structured({unit * given.parameters, unit * given.residuals, given.seed}, 60),
                share,
                1e-3);  // which are neighbours is decided in float: a few are others
  }
  const Eigen::Matrix2d turn = Eigen::Rotation2Dd(1.1).toRotationMatrix();
  EXPECT_NEAR(Structured({(turn * given.parameters).colwise() + Eigen::Vector2d(5, -7),
                          given.residuals,
                          given.seed},
                         60),
              share,
              1e-3);
  // Other places are looked at: 400 of 4000.
  EXPECT_NEAR(Structured(Shuffled(given, 6), 60), share, 0.03);
  const SurfaceResiduals few = Scattered(300, Waves(2), 0.5, 5);
  EXPECT_NEAR(Structured(Shuffled(few, 6), 9), Structured(few, 9), kIterated);
}

TEST(StructuredShareTest, OfFewPointsIsOneAndOfNoneOffIsZero) {
  EXPECT_EQ(Structured(Scattered(47, Nothing, 1, 1), 16), 1);  // nothing to tell from
  EXPECT_LT(Structured(Scattered(48, Nothing, 1, 1), 16), 0.5);
  EXPECT_EQ(Structured(Scattered(500, Nothing, 0, 1), 16), 0);
}

TEST(StructuredShareTest, SurvivesDuplicatesAndPlacesOnALine) {
  SurfaceResiduals given = Scattered(2000, Nothing, 1, 7);
  // There a quadric has three coefficients or one, not six: the share is below 0.
  given.parameters.row(1).setZero();
  EXPECT_NEAR(Structured(given, 30), 1 - 30.0 / 27, 0.08);
  // In one place every neighbourhood is the same 33 points, whose mean alone is told apart. That
  // scatters by 0.05 from cloud to cloud, so their mean by a tenth of it.
  constexpr int kClouds = 100;
  double mean = 0;
  for (unsigned seed = 1; seed <= kClouds; ++seed) {
    given = Scattered(2000, Nothing, 1, seed);
    given.parameters.setZero();
    mean += Structured(given, 30) / kClouds;
  }
  EXPECT_NEAR(mean, 1 - 32.0 / 27, 0.02);
}

// A share of the points a distance away, others of one height, both with noise.
SurfaceResiduals TwoHeights(double share, double apart, double sigma, unsigned seed) {
  SurfaceResiduals given = Scattered(6000, Nothing, sigma, seed);
  std::mt19937_64 engine(seed + 100);
  std::uniform_real_distribution<double> uniform;
  for (double& x : given.residuals) x += apart * ((uniform(engine) < share ? 1 : 0) - share);
  return given;
}

TEST(DoubleLayerFractionOfTest, IsLargeForTwoSheetsAtAnyDistance) {
  const double spacing = Side(6000);
  for (const double share : {0.5, 0.3}) {
    for (const double apart : {1.0, 4.0, 8.0, 16.0, 1e4}) {
      SCOPED_TRACE("share " + std::to_string(share) + ", " + std::to_string(apart) +
                   " spacings apart");
      for (const double unit : {1.0, apart == 16 ? 1e-6 : 1e6}) {
        SurfaceResiduals given = TwoHeights(share, apart * spacing, 0.1 * spacing, 1);
        given.parameters *= unit;
        given.residuals *= unit;
        EXPECT_GT(Layered(given), 5 * kLayersAbove) << "unit " << unit;
      }
    }
  }
}

TEST(DoubleLayerFractionOfTest, IsAboutZeroOfNoiseAndOfShape) {
  const double spacing = Side(6000);
  for (const double sigma : {0.0, 1e-3, 1.0, 1e3}) {
    SCOPED_TRACE("sigma " + std::to_string(sigma));
    EXPECT_LT(Layered(Scattered(6000, Nothing, sigma * spacing, 2)), kLayersAbove / 2);
    EXPECT_LT(Layered(Scattered(6000, Waves(0.5), sigma * spacing, 2)), kLayersAbove / 2);
  }
  // Noise of long tails, a tenth of outliers to both sides.
  SurfaceResiduals tailed = Scattered(6000, Nothing, 0.1 * spacing, 3);
  for (Eigen::Index k = 0; k < 6000; k += 10) tailed.residuals[k] *= 1e3;
  EXPECT_LT(Layered(tailed), kLayersAbove / 2);
}

TEST(DoubleLayerFractionOfTest, DoesNotDependOnThreadsAndHardlyOnOrder) {
  const SurfaceResiduals given = TwoHeights(0.5, 3 * Side(6000), 0.3 * Side(6000), 4);
  EXPECT_EQ(Layered(given, 1), Layered(given, 3));
  EXPECT_EQ(Structured(given, 60, 1), Structured(given, 60, 3));
  EXPECT_NEAR(Layered(Shuffled(given, 1)), Layered(given), 0.05);  // 600 other places
}

}  // namespace batten::internal::residual_structure_test
