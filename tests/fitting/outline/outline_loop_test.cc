// SPDX-License-Identifier: MIT
#include "fitting/outline/outline_loop.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "geometry/editing/loop_nesting.h"

namespace batten::internal {
namespace {

// A polygon about zero whose vertices are as far apart as samples, more or less.
Eigen::Matrix2Xd RaggedPolygon(std::mt19937& random) {
  const int n = 12 + static_cast<int>(random() % 60);
  std::uniform_real_distribution<double> radius(2, 0.4 * n);
  Eigen::Matrix2Xd polygon(2, n);
  for (int k = 0; k < n; ++k) {
    const double angle = 2 * M_PI * k / n;
    polygon.col(k) = radius(random) * Eigen::Vector2d(std::cos(angle), std::sin(angle));
  }
  return polygon;
}

// After any pins, one about everything puts the loop on every vertex, in their order.
TEST(PinToBorderTest, WhateverPinsCameBeforeNoVertexIsLost) {
  for (unsigned seed = 0; seed < 300; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    const Eigen::Matrix2Xd polygon = RaggedPolygon(random);
    OutlineLoop loop = SampledOutline(polygon, [](const Eigen::Vector2d&) { return 0.43; });
    std::uniform_real_distribution<double> radius(1, 6);
    for (int pin = 0; pin < 3; ++pin)
      PinToBorder(loop, {polygon.col(random() % polygon.cols()), radius(random)});
    PinToBorder(loop, {Eigen::Vector2d::Zero(), std::numeric_limits<double>::infinity()});
    const auto at = [&](Eigen::Index vertex) {
      return std::ranges::find_if(loop,
                                  [&](const OutlineSample& sample) {
                                    return (sample.place - polygon.col(vertex)).norm() < 1e-4;
                                  }) -
             loop.begin();
    };
    int descents = 0;
    for (Eigen::Index k = 0; k < polygon.cols(); ++k) {
      ASSERT_LT(at(k), std::ssize(loop)) << "vertex " << k;
      descents += at((k + 1) % polygon.cols()) <= at(k) ? 1 : 0;
    }
    EXPECT_EQ(descents, 1);
    for (const OutlineSample& sample : loop) EXPECT_TRUE(sample.corner && sample.pinned);
  }
}

// Points that were moved onto one line have a border that runs along it and back.
TEST(PinToBorderTest, LeavesSpikesOut) {
  Eigen::Matrix2Xd polygon(2, 8);
  polygon << 0, 10, 10, 9.2, 10, 5, 6, 0, 0, 0, 8, 8, 8, 8, 8, 8;
  for (int first = 0; first < 8; ++first) {
    SCOPED_TRACE(first);
    Eigen::Matrix2Xd turned(2, 8);
    for (int k = 0; k < 8; ++k) turned.col(k) = polygon.col((first + k) % 8);
    OutlineLoop loop = SampledOutline(turned, [](const Eigen::Vector2d&) { return 0.0; });
    PinToBorder(loop, {Eigen::Vector2d::Zero(), std::numeric_limits<double>::infinity()});
    EXPECT_NEAR(PolygonArea(PolygonOf(loop)), 80, 1e-9);
    for (size_t k = 0; k < loop.size(); ++k) {
      const Eigen::Vector2d &a = loop[k].place, &b = loop[(k + 1) % loop.size()].place,
                            &c = loop[(k + 2) % loop.size()].place;
      const double turn = (b - a).x() * (c - b).y() - (b - a).y() * (c - b).x();
      EXPECT_TRUE(std::abs(turn) > 1e-9 || (b - a).dot(c - b) > 0) << "at " << b.transpose();
    }
  }
}

}  // namespace
}  // namespace batten::internal
