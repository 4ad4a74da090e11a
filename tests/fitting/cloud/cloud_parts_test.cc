// SPDX-License-Identifier: MIT
#include "batten/fitting/cloud_parts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "random_splines.h"

namespace batten::internal::cloud_parts_test {

struct Scene {
  PointCloud cloud;
  std::vector<int> owners;  // −1: stray
};

// Wavy square sheets of unit side, five spacings of the sparsest and more apart, each of a density
// of its own, and stray points far away; in random order.
Scene Sheets(const std::vector<int>& counts, int stray, unsigned seed) {
  RandomSplines random(seed);
  std::vector<Eigen::Vector3d> points;
  std::vector<int> owners;
  for (size_t sheet = 0; sheet < counts.size(); ++sheet) {
    for (int k = 0; k < counts[sheet]; ++k) {
      const double u = random.Real(0, 1), v = random.Real(0, 1);
      points.emplace_back(u + 1.4 * static_cast<double>(sheet), v, 0.1 * std::sin(5 * u));
      owners.push_back(static_cast<int>(sheet));
    }
  }
  for (int k = 0; k < stray; ++k) {
    points.emplace_back(3 * k, 50 + 2 * k, 9);
    owners.push_back(-1);
  }
  std::vector<size_t> order(points.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::shuffle(order.begin(), order.end(), std::mt19937(seed));
  Scene scene;
  Eigen::Matrix3Xd mixed(3, static_cast<Eigen::Index>(points.size()));
  for (size_t k = 0; k < order.size(); ++k) {
    mixed.col(static_cast<Eigen::Index>(k)) = points[order[k]];
    scene.owners.push_back(owners[order[k]]);
  }
  scene.cloud = PointCloud::FromWorld(mixed + 1e6 * Eigen::Matrix3Xd::Ones(3, mixed.cols()));
  return scene;
}

TEST(FindCloudPartsTest, PutsEverySheetIntoAPartOfItsOwn) {
  for (unsigned seed = 1; seed <= 12; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const std::vector<int> counts{4000, 1500, 600};
    const Scene scene = Sheets(counts, 5, seed);
    ThreadPool pool(2);
    const CloudParts found = FindCloudParts(scene.cloud, pool);
    ASSERT_EQ(found.parts.size(), counts.size());
    EXPECT_EQ(found.stray, 5);
    for (size_t part = 0; part < counts.size(); ++part) {
      const CloudPart& one = found.parts[part];
      EXPECT_EQ(std::ssize(one.points), counts[part]);
      EXPECT_TRUE(std::is_sorted(one.points.begin(), one.points.end()));
      EXPECT_NEAR(one.share, counts[part] / 6105.0, 1e-12);
      for (const Eigen::Index k : one.points) {
        EXPECT_EQ(scene.owners[static_cast<size_t>(k)], static_cast<int>(part));
        EXPECT_TRUE(one.box.contains(scene.cloud.World(k)));
      }
    }
  }
}

TEST(FindCloudPartsTest, IsTheSameOnAnyNumberOfThreads) {
  const Scene scene = Sheets({9000, 9000}, 40, 3);
  ThreadPool one(1), three(3);
  const CloudParts a = FindCloudParts(scene.cloud, one), b = FindCloudParts(scene.cloud, three);
  ASSERT_EQ(a.parts.size(), b.parts.size());
  for (size_t k = 0; k < a.parts.size(); ++k) EXPECT_EQ(a.parts[k].points, b.parts[k].points);
}

TEST(FindCloudPartsTest, TakesDuplicatesAndDegenerateClouds) {
  ThreadPool pool(1);
  EXPECT_THROW(FindCloudParts(PointCloud(), pool), std::invalid_argument);
  const PointCloud one(Eigen::Matrix3Xd::Ones(3, 100));
  ASSERT_EQ(FindCloudParts(one, pool).parts.size(), 1u);
  EXPECT_EQ(FindCloudParts(one, pool).parts[0].points.size(), 100u);
  const PointCloud few(Eigen::Matrix3Xd::Random(3, 7));
  EXPECT_EQ(FindCloudParts(few, pool).stray, 7);
}

// A sheet and a small ball beside it amid points scattered all around, which are no bridge: those
// near the sheet are among the nearest of no point of it.
TEST(FindCloudPartsTest, ScatteredPointsAreNoBridge) {
  constexpr int kSheet = 20000, kBall = 1000, kScattered = 700;
  for (unsigned seed = 1; seed <= 8; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    Eigen::Matrix3Xd points(3, kSheet + kBall + kScattered);
    for (Eigen::Index k = 0; k < points.cols(); ++k) {
      const double u = random.Real(0, 1), v = random.Real(0, 1);
      if (k < kSheet) {
        points.col(k) << u, v, 0.1 * std::sin(5 * u);
      } else if (k < kSheet + kBall) {
        points.col(k) = Eigen::Vector3d(0.5, 0.5, 0.45) + 0.12 * random.Vector(1).normalized();
      } else {
        points.col(k) = Eigen::Vector3d(0.5, 0.5, 0.2) + random.Vector(0.7);
      }
    }
    ThreadPool pool(2);
    const CloudParts found = FindCloudParts(PointCloud::FromWorld(points), pool);
    ASSERT_GE(found.parts.size(), 2U);
    const auto holds = [&](const CloudPart& part, Eigen::Index first, Eigen::Index count) {
      return std::ranges::count_if(part.points,
                                   [&](auto k) { return k >= first && k < first + count; });
    };
    EXPECT_EQ(holds(found.parts[0], 0, kSheet), kSheet);
    EXPECT_EQ(holds(found.parts[0], kSheet, kBall), 0);
    EXPECT_EQ(holds(found.parts[1], kSheet, kBall), kBall);
  }
}

}  // namespace batten::internal::cloud_parts_test
