// SPDX-License-Identifier: MIT
#include "fitting/ordering/curve_sequence.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "ordered_curves.h"

namespace batten::internal::curve_sequence_test {

constexpr int kCases = 100;

double MeanStep(const Eigen::Matrix3Xd& points) {
  const Eigen::Index steps = points.cols() - 1;
  return (points.rightCols(steps) - points.leftCols(steps)).colwise().norm().mean();
}

Eigen::Matrix3Xd RandomCurve(NoisyPoints& random, int count) {
  switch (random.Integer(0, 4)) {
    case 0:
      return Flower(count);
    case 1:
      return Helix(count);
    case 2:
      return FigureEight(count);
    case 3:
      return Spiral(count, 2.2);
    default:
      return Ellipse(count, random.Real(1, 3), 1);
  }
}

// The curve cut at random places into runs, which are put in a random order that is not a rotation
// of the first; each is reversed or not.
Eigen::Matrix3Xd InMixedRuns(NoisyPoints& random, const Eigen::Matrix3Xd& points, int runs) {
  const int count = static_cast<int>(points.cols());
  std::vector<int> cuts;
  for (int k = 0; k <= runs; ++k) cuts.push_back(k * count / runs);
  for (int k = 1; k < runs; ++k) cuts[k] += random.Integer(-count / (4 * runs), count / (4 * runs));
  std::vector<Eigen::Index> order, places;
  for (bool rotated = true; rotated;) {
    places = random.Shuffled(runs);
    rotated = true;
    for (int k = 0; k < runs; ++k) {
      rotated = rotated && places[(k + 1) % runs] == (places[k] + 1) % runs;
    }
  }
  for (const Eigen::Index place : places) {
    const auto begin = order.size();
    for (int k = cuts[place]; k < cuts[place + 1]; ++k) order.push_back(k);
    if (random.Integer(0, 1) == 1) std::reverse(order.begin() + begin, order.end());
  }
  return Picked(points, order);
}

template <typename Make>
int CountFollowing(int cases, const Make& make) {
  int following = 0;
  for (int seed = 0; seed < cases; ++seed) {
    NoisyPoints random(seed);
    if (FollowsCurve(make(random))) ++following;
  }
  return following;
}

TEST(FollowsCurveTest, TakesFewPointsAsTheyAre) {
  EXPECT_TRUE(FollowsCurve(Eigen::Matrix3Xd(3, 0)));
  EXPECT_TRUE(FollowsCurve(Eigen::Matrix3Xd::Ones(3, 1)));
  EXPECT_TRUE(FollowsCurve(Eigen::Matrix3Xd::Ones(3, 30)));
  EXPECT_TRUE(FollowsCurve(Arc(5, 200)));
  EXPECT_TRUE(FollowsCurve(Polyline({{0, 0, 0}, {3, 0, 0}, {3, 1, 0}, {0, 1, 0}}, 1)));
}

TEST(FollowsCurveTest, SeesTheOrderOfCoarsePoints) {
  for (int count = 6; count <= 40; ++count) {
    SCOPED_TRACE("points " + std::to_string(count));
    EXPECT_TRUE(FollowsCurve(Ellipse(count, 1, 1)));
    EXPECT_TRUE(FollowsCurve(Ellipse(count, 2, 1)));
    EXPECT_TRUE(FollowsCurve(Arc(count, 250)));
    EXPECT_TRUE(FollowsCurve(Airfoil(count, -0.1015)));
    EXPECT_TRUE(FollowsCurve(Zigzag(count, 1, 2)));
  }
}

TEST(FollowsCurveTest, SeesTheOrderThroughNoiseThickerThanTheSteps) {
  EXPECT_EQ(kCases, CountFollowing(kCases, [](NoisyPoints& random) {
              const int count = random.Integer(800, 6000);
              const Eigen::Matrix3Xd curve = RandomCurve(random, count);
              const double sigma = random.Real(0.1, std::min(50.0, count / 80.0)) * MeanStep(curve);
              return random.Scattered(curve, sigma, 2);
            }));
}

TEST(FollowsCurveTest, SeesTheOrderThroughAThirdOfOutliers) {
  EXPECT_EQ(kCases, CountFollowing(kCases, [](NoisyPoints& random) {
              Eigen::Matrix3Xd points = RandomCurve(random, random.Integer(100, 4000));
              const Eigen::Vector3d low = points.rowwise().minCoeff(),
                                    high = points.rowwise().maxCoeff();
              for (Eigen::Index k = 0; k < points.cols(); ++k) {
                if (random.Real(0, 1) > 0.3) continue;
                for (int d = 0; d < 3; ++d) points(d, k) = random.Real(low[d], high[d]);
              }
              return points;
            }));
}

TEST(FollowsCurveTest, SeesTheOrderAcrossGaps) {
  EXPECT_EQ(
      kCases, CountFollowing(kCases, [](NoisyPoints& random) {
        const int count = random.Integer(100, 4000);
        const Eigen::Matrix3Xd points = RandomCurve(random, count);
        std::vector<Eigen::Index> kept;
        const int first = random.Integer(count / 10, count / 2), second = count - count / 4;
        for (int k = 0; k < count; ++k) {
          if (k < first || (k > first + count / 10 && k < second) || k > second + count / 20) {
            kept.push_back(k);
          }
        }
        return Picked(points, kept);
      }));
}

// Dense arcs at the corners, ends only along the sides, thin or square, closed or not.
TEST(FollowsCurveTest, SeesTheOrderOfARoundedRectangle) {
  EXPECT_EQ(
      kCases, CountFollowing(kCases, [](NoisyPoints& random) {
        const double w = random.Real(0.5, 20), h = random.Real(0.5, 20),
                     r = random.Real(0.05, 0.24);
        const int steps = random.Integer(4, 40);
        const bool repeated = random.Integer(0, 1) == 1;
        Eigen::Matrix3Xd points(3, 4 * (steps + 1) + (repeated ? 1 : 0));
        for (int corner = 0; corner < 4; ++corner) {
          const double x = corner == 0 || corner == 3 ? w - r : r, y = corner < 2 ? h - r : r;
          for (int k = 0; k <= steps; ++k) {
            const double angle = 0.5 * std::numbers::pi * (corner + static_cast<double>(k) / steps);
            points.col(corner * (steps + 1) + k) = Eigen::Vector3d(x, y, 0) + r * OnCircle(angle);
          }
        }
        if (repeated) points.rightCols<1>() = points.col(0);
        return points;
      }));
}

TEST(FollowsCurveTest, RefusesShuffledPoints) {
  EXPECT_EQ(0, CountFollowing(kCases, [](NoisyPoints& random) {
              const int count = random.Integer(40, 5000);
              const Eigen::Matrix3Xd curve = RandomCurve(random, count);
              const Eigen::Matrix3Xd points = random.Scattered(curve, random.Real(0, 0.02), 2);
              return Picked(points, random.Shuffled(count));
            }));
}

// With few runs their ends may happen to meet nothing; a twentieth is granted.
TEST(FollowsCurveTest, RefusesRunsInMixedOrder) {
  EXPECT_LE(CountFollowing(kCases,
                           [](NoisyPoints& random) {
                             const int runs = random.Integer(4, 30);
                             const Eigen::Matrix3Xd curve =
                                 RandomCurve(random, random.Integer(20, 200) * runs);
                             return InMixedRuns(
                                 random, random.Scattered(curve, 0.2 * MeanStep(curve), 2), runs);
                           }),
            kCases / 20);
}

TEST(FollowsCurveTest, RefusesHalvesOfAClosedCurveThatDoNotMeet) {
  EXPECT_EQ(0, CountFollowing(kCases, [](NoisyPoints& random) {
              const int count = random.Integer(20, 4000), begin = random.Integer(0, count - 1);
              std::vector<Eigen::Index> order;
              for (int k = 0; k < count; ++k) order.push_back((begin + k) % count);
              std::reverse(order.begin() + count / 2, order.end());
              return Picked(Ellipse(count, random.Real(1, 2), 1), order);
            }));
}

TEST(FollowsCurveTest, RefusesTwoClosedCurvesOneAfterTheOther) {
  Eigen::Matrix3Xd points(3, 300);
  points << Ellipse(200, 1, 1), Ellipse(100, 0.5, 0.4);
  EXPECT_FALSE(FollowsCurve(points));
}

TEST(FollowsCurveTest, DoesNotDependOnUnitsOrPlace) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    NoisyPoints random(seed);
    Eigen::Matrix3Xd points = RandomCurve(random, random.Integer(60, 500));
    if (seed % 2 == 0) points = InMixedRuns(random, points, 5);
    const bool follows = FollowsCurve(points);
    for (const double scale : {1e-6, 1e6}) {
      const Eigen::Matrix3Xd moved =
          (scale * points).colwise() + Eigen::Vector3d(50, -70, 9) * scale;
      EXPECT_EQ(FollowsCurve(moved), follows);
    }
  }
}

}  // namespace batten::internal::curve_sequence_test
