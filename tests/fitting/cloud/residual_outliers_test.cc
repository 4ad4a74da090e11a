// SPDX-License-Identifier: MIT
#include "fitting/cloud/residual_outliers.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <random>
#include <string>
#include <vector>

namespace batten::internal::residual_outliers_test {

constexpr double kSigma = 1e-3, kLimit = 5 * kSigma;

struct Distances {
  Eigen::Matrix2Xd places;
  Eigen::VectorXd distances;
};

// Scattered over the unit square: noise of kSigma, uniform within its limit of 1.7 sigma.
Distances Quiet(Eigen::Index count, unsigned seed) {
  std::mt19937_64 engine(seed);
  std::uniform_real_distribution<double> place, noise(-1, 1);
  Distances given{Eigen::Matrix2Xd(2, count), Eigen::VectorXd(count)};
  for (Eigen::Index k = 0; k < count; ++k) {
    given.places.col(k) << place(engine), place(engine);
    given.distances[k] = std::sqrt(3) * kSigma * noise(engine);
  }
  return given;
}

TEST(OutlierThresholdTest, IsWhereTheTailIsFlat) {
  std::mt19937_64 engine(9);
  std::normal_distribution<double> normal;
  Eigen::VectorXd distances(10000);
  for (double& x : distances) x = kSigma * normal(engine);
  EXPECT_EQ(OutlierThreshold(distances, kLimit), std::numeric_limits<double>::infinity());
  // Outliers up to a thousand times the limit: most of those beyond are beyond twice.
  std::uniform_real_distribution<double> far(-1000 * kLimit, 1000 * kLimit);
  for (Eigen::Index k = 0; k < 10000; k += 50) distances[k] = far(engine);
  for (const double unit : {1e-6, 1.0, 1e6}) {
    EXPECT_EQ(OutlierThreshold(unit * distances, unit * kLimit), unit * kLimit) << unit;
  }
  EXPECT_EQ(OutlierThreshold(distances, 0), std::numeric_limits<double>::infinity());
}

TEST(ResidualInliersTest, TakesAwayTheLonelyAndKeepsStructure) {
  ThreadPool pool(2);
  const double spacing = 1 / std::sqrt(4000);
  Distances given = Quiet(4000, 10);
  // A patch of structure beyond the limit, and outliers far beyond everything.
  for (Eigen::Index k = 0; k < 4000; ++k) {
    if ((given.places.col(k).array() < 0.3).all()) given.distances[k] += 3 * spacing;
  }
  std::vector<Eigen::Index> outliers;
  for (Eigen::Index k = 0; k < 4000; k += 40) {
    if ((given.places.col(k).array() < 0.35).all()) continue;
    outliers.push_back(k);
    given.distances[k] = (k % 80 == 0 ? 1 : -1) * (1 + 1e-3 * static_cast<double>(k));
  }
  const PointMask close = ResidualInliers(given.places, given.distances, kLimit, spacing, pool);
  const PointMask marked = !close(outliers);
  EXPECT_TRUE(marked.all());
  // But those, all are close, but for some at the rim of the patch.
  const Eigen::Index lost = 4000 - close.count() - std::ssize(outliers);
  EXPECT_LE(lost, 10);
  ThreadPool one(1);
  EXPECT_TRUE(
      (ResidualInliers(given.places, given.distances, kLimit, spacing, one) == close).all());
}

TEST(ResidualInliersTest, BelievesAtAnyDistanceOnlyThoseWhoAgree) {
  ThreadPool pool(2);
  const double spacing = 1 / std::sqrt(4000);
  std::mt19937_64 engine(11);
  std::uniform_real_distribution<double> uniform;
  // The share of a patch that is kept, off by `least` to (1 + spread) times that.
  const auto kept = [&](double least, double spread) {
    Distances given = Quiet(4000, 12);
    PointMask patch = PointMask::Constant(4000, false);
    for (Eigen::Index k = 0; k < 4000; ++k) {
      if (!(given.places.col(k).array() < 0.3).all()) continue;
      patch[k] = true;
      given.distances[k] = least * (1 + spread * uniform(engine));
    }
    const PointMask close = ResidualInliers(given.places, given.distances, kLimit, spacing, pool);
    return static_cast<double>((close && patch).count()) / static_cast<double>(patch.count());
  };
  EXPECT_GT(kept(300 * spacing, 0.1), 0.9);  // all but the rim
  EXPECT_GT(kept(2 * spacing, 0.9), 0.9);
  EXPECT_LT(kept(300 * spacing, 0.9), 0.7);
}

}  // namespace batten::internal::residual_outliers_test
