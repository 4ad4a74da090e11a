// SPDX-License-Identifier: MIT
#include "batten/fitting/strangers.h"

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

namespace batten {
namespace {

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

double Share(const Distances& given, double limit = kLimit, int threads = 2) {
  ThreadPool pool(threads);
  return LonelyShare(given.places, given.distances, limit, pool);
}

// Points of these indices are put off by any amount up to `farthest`, to either side.
void PutOff(Distances& given, Eigen::Index every, double farthest, unsigned seed) {
  std::mt19937_64 engine(seed);
  std::uniform_real_distribution<double> uniform;
  for (Eigen::Index k = 0; k < given.distances.size(); k += every) {
    const double off = 2 * kLimit + farthest * uniform(engine);
    given.distances[k] = uniform(engine) < 0.5 ? off : -off;
  }
}

TEST(LonelyShareTest, IsTheShareOfScatteredOutliers) {
  for (const Eigen::Index every : {20, 50, 200}) {
    for (const double farthest : {0.03, 1.0, 1e6}) {
      for (unsigned seed = 1; seed <= 3; ++seed) {
        SCOPED_TRACE("one in " + std::to_string(every) + ", up to " + std::to_string(farthest) +
                     ", seed " + std::to_string(seed));
        Distances given = Quiet(4000, seed);
        PutOff(given, every, farthest, seed);
        const double share = 1 / static_cast<double>(every);
        // That three of eight neighbours are off alike happens to one in hundreds at most:
        // 56 · (0.05 / 2)³ < 1e-3.
        EXPECT_LE(Share(given), share);
        EXPECT_GE(Share(given), 0.98 * share);
      }
    }
  }
}

TEST(LonelyShareTest, IsZeroWithinTheLimitAndOfStructure) {
  Distances given = Quiet(4000, 4);
  EXPECT_EQ(Share(given), 0);
  EXPECT_EQ(Share(given, given.distances.cwiseAbs().maxCoeff()), 0);
  // A ridge the surface has missed, much higher than the limit, forty spacings long and ten wide.
  for (Eigen::Index k = 0; k < 4000; ++k) {
    const Eigen::Vector2d p = given.places.col(k);
    given.distances[k] +=
        40 * kSigma * std::exp(-std::pow((p[0] - 0.5) / 0.08, 2)) * std::sin(3 * p[1]);
  }
  ASSERT_GT((given.distances.array().abs() > kLimit).count(), 500);
  EXPECT_LT(Share(given), 2e-3);
  // A patch that is off by the same everywhere.
  Distances patch = Quiet(4000, 5);
  for (Eigen::Index k = 0; k < 4000; ++k) {
    if ((patch.places.col(k).array() < 0.3).all()) patch.distances[k] -= 1;
  }
  EXPECT_LE(Share(patch), 1e-3);  // a point or two at its corner
}

TEST(LonelyShareTest, TellsSidesApart) {
  // All off to one side: none is alone.
  Distances given = Quiet(2000, 6);
  given.distances.setOnes();
  EXPECT_EQ(Share(given), 0);
  given.distances = -given.distances;
  EXPECT_EQ(Share(given), 0);
  // A lattice whose diagonals take turns: four of the eight neighbours are on the same side …
  Distances lattice{Eigen::Matrix2Xd(2, 2500), Eigen::VectorXd(2500)};
  for (int k = 0; k < 2500; ++k) {
    lattice.places.col(k) << k / 50, k % 50;
    lattice.distances[k] = (k / 50 + k % 50) % 2 == 0 ? 1 : -1;
  }
  EXPECT_LT(Share(lattice), 0.1);
  // … fewer than three of eight where each chooses by chance: (1 + 8 + 28) / 256.
  std::mt19937_64 engine(6);
  for (double& x : lattice.distances) x = engine() % 2 == 0 ? 1 : -1;
  EXPECT_NEAR(Share(lattice), 37 / 256.0, 0.03);
  // Ten times as far as all around it is alone as well.
  given.distances.setOnes();
  for (Eigen::Index k = 0; k < 2000; k += 50) given.distances[k] = 10;
  EXPECT_EQ(Share(given), 0.02);
  // … and none if one of nine is off.
  for (int k = 0; k < 2500; ++k) {
    lattice.distances[k] = (k / 50) % 3 == 0 && (k % 50) % 3 == 0 ? 1 : 0;
  }
  EXPECT_EQ(Share(lattice), 17 * 17 / 2500.0);
}

TEST(LonelyShareTest, DoesNotDependOnUnitsMotionsSignOrderOrThreads) {
  Distances given = Quiet(3000, 7);
  PutOff(given, 15, 0.03, 7);
  const double share = Share(given);
  ASSERT_GT(share, 0.05);
  for (const double unit : {1e-6, 1e6}) {
    SCOPED_TRACE("unit " + std::to_string(unit));
    EXPECT_EQ(Share({unit * given.places, unit * given.distances}, unit * kLimit), share);
    EXPECT_EQ(Share({given.places, unit * given.distances}, unit * kLimit), share);
  }
  const Eigen::Matrix2d turn = Eigen::Rotation2Dd(1.1).toRotationMatrix();
  EXPECT_EQ(Share({turn * given.places, -given.distances}), share);
  std::vector<Eigen::Index> order(3000);
  std::iota(order.begin(), order.end(), 0);
  std::shuffle(order.begin(), order.end(), std::mt19937_64(8));
  EXPECT_EQ(Share({given.places(Eigen::all, order), given.distances(order)}), share);
  EXPECT_EQ(Share(given, kLimit, 1), Share(given, kLimit, 3));
}

TEST(LonelyShareTest, OfFewPointsIsEveryOneThatIsOff) {
  for (Eigen::Index count = 1; count <= 3; ++count) {
    EXPECT_EQ(Share({Eigen::Matrix2Xd::Random(2, count), Eigen::VectorXd::Ones(count)}), 1);
  }
  EXPECT_EQ(Share({Eigen::Matrix2Xd::Zero(2, 0), Eigen::VectorXd(0)}), 0);
}

TEST(StrangersBeginTest, IsWhereTheTailIsFlat) {
  std::mt19937_64 engine(9);
  std::normal_distribution<double> normal;
  Eigen::VectorXd distances(10000);
  for (double& x : distances) x = kSigma * normal(engine);
  EXPECT_EQ(StrangersBegin(distances, kLimit), std::numeric_limits<double>::infinity());
  // Outliers up to a thousand times the limit: most of those beyond are beyond twice.
  std::uniform_real_distribution<double> far(-1000 * kLimit, 1000 * kLimit);
  for (Eigen::Index k = 0; k < 10000; k += 50) distances[k] = far(engine);
  for (const double unit : {1e-6, 1.0, 1e6}) {
    EXPECT_EQ(StrangersBegin(unit * distances, unit * kLimit), unit * kLimit) << unit;
  }
  EXPECT_EQ(StrangersBegin(distances, 0), std::numeric_limits<double>::infinity());
}

TEST(CloseEnoughTest, TakesAwayTheLonelyAndKeepsStructure) {
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
  const PointMask close = CloseEnough(given.places, given.distances, kLimit, spacing, pool);
  const PointMask marked = !close(outliers);
  EXPECT_TRUE(marked.all());
  // But those, all are close, but for some at the rim of the patch.
  const Eigen::Index lost = 4000 - close.count() - std::ssize(outliers);
  EXPECT_LE(lost, 10);
  ThreadPool one(1);
  EXPECT_TRUE((CloseEnough(given.places, given.distances, kLimit, spacing, one) == close).all());
}

TEST(CloseEnoughTest, BelievesAtAnyDistanceOnlyThoseWhoAgree) {
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
    const PointMask close = CloseEnough(given.places, given.distances, kLimit, spacing, pool);
    return static_cast<double>((close && patch).count()) / static_cast<double>(patch.count());
  };
  EXPECT_GT(kept(300 * spacing, 0.1), 0.9);  // all but the rim
  EXPECT_GT(kept(2 * spacing, 0.9), 0.9);
  EXPECT_LT(kept(300 * spacing, 0.9), 0.7);
}

}  // namespace
}  // namespace batten
