// SPDX-License-Identifier: MIT
#include "batten/geometry/points_into.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <vector>

#include "random_splines.h"

namespace batten::internal::points_into_test {

// Around the sizes of blocks, on one and on several threads.
TEST(PointsIntoTest, GivesWhatPointsGives) {
  RandomSplines random(20240611);
  const SurfaceEvaluator evaluator(random.Surface(3, 2, true));
  for (const int threads : {1, 3}) {
    ThreadPool pool(threads);
    for (const std::size_t count : {0, 1, 511, 512, 513, 4097, 20000}) {
      std::vector<double> us(count), vs(count), points(3 * count);
      Eigen::Matrix2Xd parameters(2, static_cast<Eigen::Index>(count));
      for (std::size_t k = 0; k < count; ++k) {
        us[k] = random.Real(-9, 9);  // also outside
        vs[k] = random.Real(-9, 9);
        parameters.col(static_cast<Eigen::Index>(k)) << us[k], vs[k];
      }
      PointsInto(evaluator, us, vs, points, pool);
      Eigen::Matrix3Xd expected;
      evaluator.Points(parameters, expected);
      EXPECT_TRUE(std::equal(points.begin(), points.end(), expected.data())) << count;
    }
  }
}

TEST(PointsIntoTest, RefusesWhatDoesNotFit) {
  RandomSplines random(20240612);
  const SurfaceEvaluator evaluator(random.Surface(2, 2, false));
  ThreadPool pool(1);
  std::vector<double> two(2, 0.5), three(3, 0.5), points(6);
  EXPECT_THROW(PointsInto(evaluator, two, three, points, pool), std::invalid_argument);
  EXPECT_THROW(PointsInto(evaluator, three, three, points, pool), std::invalid_argument);
  two[1] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(PointsInto(evaluator, two, two, points, pool), std::invalid_argument);
}

}  // namespace batten::internal::points_into_test
