// SPDX-License-Identifier: MIT
#include "batten/fitting/statistics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "random_splines.h"
#include "tolerances.h"

namespace batten::internal::statistics_test {

std::vector<double> RandomSample(RandomSplines& random, int count) {
  std::vector<double> values(count);
  // Whole numbers now and then, so that ties occur.
  for (double& value : values) value = random.Coin() ? random.Integer(-3, 3) : random.Real(-3, 3);
  return values;
}

TEST(QuantileTest, IsLinearBetweenTheSortedValues) {
  for (unsigned seed = 0; seed < 200; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const std::vector<double> values = RandomSample(random, random.Integer(2, 60));
    std::vector<double> sorted = values;
    std::sort(sorted.begin(), sorted.end());
    const double fraction = random.Real(0, 1);
    const double position = fraction * static_cast<double>(sorted.size() - 1);
    const auto low = static_cast<size_t>(std::floor(position));
    const size_t high = std::min(low + 1, sorted.size() - 1);
    const double expected = std::lerp(sorted[low], sorted[high], position - std::floor(position));
    EXPECT_NEAR(Quantile(values, fraction), expected, kRounding) << "fraction " << fraction;
  }
}

TEST(QuantileTest, TakesTheExtremesAtAndBeyondTheEnds) {
  RandomSplines random(1);
  const std::vector<double> values = RandomSample(random, 37);
  const auto [least, greatest] = std::minmax_element(values.begin(), values.end());
  for (const double fraction : {0.0, -1.0}) EXPECT_EQ(Quantile(values, fraction), *least);
  for (const double fraction : {1.0, 2.0}) EXPECT_EQ(Quantile(values, fraction), *greatest);
}

TEST(QuantileTest, DoesNotDependOnTheOrder) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    std::vector<double> values = RandomSample(random, 25);
    const double fraction = random.Real(0, 1), before = Quantile(values, fraction);
    std::reverse(values.begin(), values.end());
    EXPECT_EQ(Quantile(values, fraction), before);
    std::sort(values.begin(), values.end());
    EXPECT_EQ(Quantile(values, fraction), before);
  }
}

TEST(QuantileTest, NeverFallsAsTheFractionGrows) {
  RandomSplines random(2);
  const std::vector<double> values = RandomSample(random, 50);
  double previous = Quantile(values, 0);
  for (int k = 1; k <= 1000; ++k) {
    const double next = Quantile(values, k / 1000.0);
    EXPECT_GE(next, previous) << "fraction " << k / 1000.0;
    previous = next;
  }
}

TEST(QuantileTest, OfASingleValueIsThatValue) {
  for (const double fraction : {0.0, 0.3, 1.0}) EXPECT_EQ(Quantile({7.5}, fraction), 7.5);
}

TEST(QuantileTest, OfNothingIsNotANumber) {
  EXPECT_TRUE(std::isnan(Quantile({}, 0.5)));
  EXPECT_TRUE(std::isnan(Median({})));
}

TEST(MedianTest, IsTheMiddleValueOrTheMeanOfTheTwoMiddleOnes) {
  EXPECT_EQ(Median({3, 1, 2}), 2);
  EXPECT_EQ(Median({4, 1, 2, 3}), 2.5);
}

TEST(WeightedMedianTest, IsTheLowerMiddleOfValuesRepeatedAsOftenAsTheyWeigh) {
  RandomSplines random(11);
  for (int round = 0; round < 100; ++round) {
    SCOPED_TRACE(round);
    std::vector<std::pair<double, double>> weighted;
    std::vector<double> repeated;
    for (const double value : RandomSample(random, 1 + round % 20)) {
      const int times = random.Integer(1, 5);
      weighted.emplace_back(value, times);
      repeated.insert(repeated.end(), times, value);
    }
    std::sort(repeated.begin(), repeated.end());
    EXPECT_EQ(WeightedMedian(weighted), repeated[(repeated.size() - 1) / 2]);
  }
  EXPECT_TRUE(std::isnan(WeightedMedian({})));
}

}  // namespace batten::internal::statistics_test
