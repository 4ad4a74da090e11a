// SPDX-License-Identifier: MIT
#include "fitting/parameterization/connected_components.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include "tolerances.h"

namespace batten::internal::connected_components_test {

using Inside = bool (*)(double, double);

bool Everywhere(double, double) { return true; }

// Over the part of the unit square that is inside, density^-x as dense at x as at 0.
Eigen::Matrix2Xd Scattered(Eigen::Index count, Inside inside, double density, unsigned seed) {
  std::mt19937_64 engine(seed);
  std::uniform_real_distribution<double> uniform;
  Eigen::Matrix2Xd places(2, count);
  for (auto place : places.colwise()) {
    do {
      double x = uniform(engine);
      if (density != 1) x = -std::log(1 - x * (1 - 1 / density)) / std::log(density);
      place << x, uniform(engine);
    } while (!inside(place[0], place[1]));
  }
  return places;
}

// Patches of sizes of their own in a row, with gaps of so many spacings of the coarser neighbour.
// Every patch is a square whose spacing is 1.
Eigen::Matrix2Xd Patches(const std::vector<Eigen::Index>& counts, double gap, unsigned seed) {
  Eigen::Matrix2Xd places(2, 0);
  double from = 0;
  for (const Eigen::Index count : counts) {
    const double side = std::sqrt(static_cast<double>(count));
    Eigen::Matrix2Xd patch = side * Scattered(count, Everywhere, 1, seed++);
    patch.row(0).array() += from;
    from += side + gap;
    const Eigen::Index before = places.cols();
    places.conservativeResize(2, before + count);
    places.rightCols(count) = patch;
  }
  return places;
}

Eigen::Matrix2Xd Lattice(int rows, int columns, double step_u, double step_v) {
  Eigen::Matrix2Xd places(2, rows * columns);
  for (int k = 0; k < rows * columns; ++k)
    places.col(k) << step_u * (k / columns), step_v * (k % columns);
  return places;
}

TEST(DetachedFractionTest, IsZeroForOnePieceOfAnyOutline) {
  const Inside outlines[] = {
      Everywhere,
      [](double x, double y) { return x < 0.3 || y < 0.3; },  // an L
      [](double x, double y) {                                // a ring
        const double r = std::hypot(x - 0.5, y - 0.5);
        return r < 0.5 && r > 0.45;
      },
      [](double x, double y) { return std::abs(x - 0.5) > 0.2 || std::abs(y - 0.5) < 0.05; },  // H
  };
  for (size_t shape = 0; shape < std::size(outlines); ++shape) {
    for (const Eigen::Index count : {200, 2000, 30000}) {
      for (unsigned seed = 1; seed <= 2; ++seed) {
        SCOPED_TRACE("outline " + std::to_string(shape) + ", " + std::to_string(count) +
                     " points, seed " + std::to_string(seed));
        EXPECT_EQ(DetachedFraction(Scattered(count, outlines[shape], 1, seed)), 0);
      }
    }
  }
}

TEST(DetachedFractionTest, IsZeroForDensitiesThatDiffer) {
  for (const double density : {10.0, 100.0, 1e4}) {
    for (unsigned seed = 1; seed <= 3; ++seed) {
      SCOPED_TRACE("density " + std::to_string(density) + ", seed " + std::to_string(seed));
      EXPECT_EQ(DetachedFraction(Scattered(10000, Everywhere, density, seed)), 0);
    }
  }
  // A dense patch in the middle of a coarse field, hundred times as dense.
  Eigen::Matrix2Xd both(2, 11000);
  both << 10 * Scattered(1000, Everywhere, 1, 4),
      (Scattered(10000, Everywhere, 1, 5).array() + 4.5).matrix();
  EXPECT_EQ(DetachedFraction(both), 0);
  // Beside it, five of the field's spacings away, which are fifty of the patch's.
  both.rightCols(10000).row(0).array() += 7;
  EXPECT_EQ(DetachedFraction(both), 0);
}

TEST(DetachedFractionTest, IsZeroForLatticesAndScanLines) {
  EXPECT_EQ(DetachedFraction(Lattice(100, 80, 1, 1)), 0);
  EXPECT_EQ(DetachedFraction(Lattice(300, 300, 1e-3, 2e-3)), 0);
  for (const double ratio : {5.0, 20.0}) {
    SCOPED_TRACE("lines " + std::to_string(ratio) + " spacings apart");
    EXPECT_EQ(DetachedFraction(Lattice(20, 300, ratio, 1)), 0);
  }
}

TEST(DetachedFractionTest, IsTheShareOfTheLesserParts) {
  std::mt19937_64 engine(6);
  std::uniform_int_distribution<Eigen::Index> size(30, 3000);
  for (int round = 0; round < 20; ++round) {
    std::vector<Eigen::Index> counts(2 + round % 2);
    for (Eigen::Index& count : counts) count = size(engine);
    const double all = static_cast<double>(std::accumulate(counts.begin(), counts.end(), 0L));
    const double largest = static_cast<double>(*std::max_element(counts.begin(), counts.end()));
    SCOPED_TRACE("round " + std::to_string(round) + ", first part " + std::to_string(counts[0]));
    // Of nine neighbours in the middle of scattered points the farthest is 1.7 spacings away, at a
    // corner three or four.
    EXPECT_NEAR(DetachedFraction(Patches(counts, 60, round)), 1 - largest / all, kRounding);
    EXPECT_EQ(DetachedFraction(Patches(counts, 8, round)), 0);
  }
}

TEST(DetachedFractionTest, IsTheShareOfASampleOfManyPoints) {
  // 20 000 of 60 000 points are looked at, so that spacings are √3 as large.
  EXPECT_NEAR(
      DetachedFraction(Patches({45000, 15000}, 100, 1)), 0.25, 0.02);  // 6 σ: √(.25·.75/20000)
  EXPECT_EQ(DetachedFraction(Patches({45000, 15000}, 100, 1), 5),
            DetachedFraction(Patches({45000, 15000}, 100, 1), 5));
}

TEST(DetachedFractionTest, JoinsPartsByWayOfOthers) {
  // Stepping stones of 12 points, 5 spacings from each other; without them all is apart.
  Eigen::Matrix2Xd two = Patches({2500, 1600}, 80, 2);
  EXPECT_DOUBLE_EQ(DetachedFraction(two), 1600.0 / 4100);
  for (double x = 56; x < 130; x += 8) {
    two.conservativeResize(2, two.cols() + 12);
    two.rightCols(12) = 3 * Scattered(12, Everywhere, 1, 3);
    two.rightCols(12).colwise() += Eigen::Vector2d(x, 20);
  }
  EXPECT_EQ(DetachedFraction(two), 0);
}

TEST(DetachedFractionTest, TurnsAndScalesWithThePointsInAnyOrder) {
  const Eigen::Matrix2Xd places = Patches({900, 500, 200}, 70, 9);
  const Eigen::Matrix2d turn = Eigen::Rotation2Dd(0.8).toRotationMatrix();
  for (const double unit : {1e-6, 1.0, 1e6}) {
    SCOPED_TRACE("unit " + std::to_string(unit));
    EXPECT_DOUBLE_EQ(
        DetachedFraction(unit * ((turn * places).colwise() + Eigen::Vector2d(100, -300))),
        700.0 / 1600);
  }
  std::vector<Eigen::Index> order(1600);
  std::iota(order.begin(), order.end(), 0);
  std::shuffle(order.begin(), order.end(), std::mt19937_64(10));
  EXPECT_DOUBLE_EQ(DetachedFraction(places(Eigen::all, order)), 700.0 / 1600);
}

TEST(DetachedFractionTest, IsNotMisledByDuplicatesNorByPlacesOverEachOther) {
  // Rulings of a cylinder seen along its axis: 50 points each place, exactly or nearly.
  for (const double jitter : {0.0, 1e-9, 1e-3}) {
    SCOPED_TRACE("jitter " + std::to_string(jitter));
    const Eigen::Matrix2Xd noise = Scattered(15000, Everywhere, 1, 11);
    Eigen::Matrix2Xd arc(2, 15000);
    for (int k = 0; k < 15000; ++k) {
      const double angle = 0.02 * (k / 50);
      arc.col(k) = Eigen::Vector2d(std::cos(angle), std::sin(angle)) + jitter * noise.col(k);
    }
    EXPECT_EQ(DetachedFraction(arc), 0);
    // Two such arcs are two.
    Eigen::Matrix2Xd two = arc;
    two.leftCols(6000).colwise() += Eigen::Vector2d(10, 0);
    EXPECT_DOUBLE_EQ(DetachedFraction(two), 0.4);
  }
  const Eigen::Matrix2Xd once = Patches({900, 300}, 60, 12);
  Eigen::Matrix2Xd often(2, 12 * once.cols());
  for (int k = 0; k < 12; ++k) often.middleCols(k * once.cols(), once.cols()) = once;
  EXPECT_DOUBLE_EQ(DetachedFraction(often), 0.25);
}

TEST(DetachedFractionTest, OfFewPointsIsZero) {
  for (Eigen::Index count = 0; count <= 9; ++count) {
    EXPECT_EQ(DetachedFraction(Scattered(count, Everywhere, 1, 1)), 0) << count;
  }
  EXPECT_EQ(DetachedFraction(Eigen::Matrix2Xd::Zero(2, 100)), 0);
}

}  // namespace batten::internal::connected_components_test
