// SPDX-License-Identifier: MIT
#include "fitting/wings/density_end.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace batten::internal::density_end_test {

constexpr double kNoise = 5e-3, kSlope = 0.03, kOffset = 0.2;

EndingPoints Drawn(Eigen::Index count, unsigned seed) {
  std::mt19937_64 engine(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::normal_distribution<double> normal(0, kNoise);
  EndingPoints points{Eigen::MatrixXd(count, 2), Eigen::VectorXd(count), Eigen::VectorXd(count)};
  for (Eigen::Index k = 0; k < count; ++k) {
    const double t = uniform(engine);
    points.place[k] = t;
    points.along.row(k) << 1, 2 * t - 1;
    points.reach[k] = kOffset + kSlope * (2 * t - 1) - uniform(engine) + normal(engine);
  }
  return points;
}

// Standard errors by the information that n points over a unit carry of their end, 0.9 n/noise, and
// of a slope over -1 ... 1, a third of it.
constexpr Eigen::Index kCount = 20000;
const double kErrorOfEnd = std::sqrt(kNoise / (0.9 * kCount)),
             kErrorOfSlope = std::sqrt(3.0) * kErrorOfEnd;
constexpr double kErrors = 4;

// Law: the end of a line of even density is found to a fraction of the noise, not at the outermost
// points, which lie two to three noises beyond it.
TEST(EndOfPointsTest, IsWhereEvenDensityEnds) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const auto end = EndOfPoints(Drawn(kCount, seed), kNoise, 0.1);
    ASSERT_TRUE(end.has_value());
    EXPECT_NEAR((*end)[0], kOffset, kErrors * kErrorOfEnd);
    EXPECT_NEAR((*end)[1], kSlope, kErrors * kErrorOfSlope);
  }
}

TEST(EndOfPointsTest, AsksForPoints) {
  EXPECT_FALSE(EndOfPoints(Drawn(30, 1), kNoise, 0.1).has_value());
}

}  // namespace batten::internal::density_end_test
