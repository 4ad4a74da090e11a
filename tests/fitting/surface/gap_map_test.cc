// SPDX-License-Identifier: MIT
#include "fitting/surface/gap_map.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "batten/geometry/knot_vectors.h"
#include "closed_shapes.h"
#include "tolerances.h"

namespace batten::internal::gap_map_test {

constexpr int kPoints = 6000;
constexpr double kLengthU = 2, kLengthV = 1;
const double kSpacing = std::sqrt(kLengthU * kLengthV / kPoints);

using Where = std::function<bool(double, double)>;

SplineBasis Basis(bool round, double length) {
  return round ? PeriodicUniformKnots(3, 8, 0, length) : SplineBasis::Uniform(3, 8, 0, length);
}

// Scattered evenly where asked for.
FittingProblem Problem(const Where& where, bool round_u, bool round_v, unsigned seed = 1) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  auto data = std::make_shared<FittingData>();
  data->parameters.resize(2, kPoints);
  for (int k = 0; k < kPoints;) {
    const double u = kLengthU * uniform(random), v = kLengthV * uniform(random);
    if (where(u, v)) data->parameters.col(k++) << u, v;
  }
  data->values = Eigen::MatrixXd::Zero(3, kPoints);
  return {Basis(round_u, kLengthU), Basis(round_v, kLengthV), std::move(data), 1e-4};
}

GapMap MapOf(const Where& where, bool round_u, bool round_v = false, unsigned seed = 1) {
  return {Problem(where, round_u, round_v, seed), kPoints, kSpacing};
}

// Outside a disc, distances measured round circles.
Where Outside(double u, double v, double radius) {
  return [=](double x, double y) {
    const double du = std::abs(x - u), dv = std::abs(y - v);
    return std::hypot(std::min(du, kLengthU - du), std::min(dv, kLengthV - dv)) > radius;
  };
}

TEST(GapMapTest, FindsNoneWherePointsAreEven) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    for (const bool round : {false, true}) {
      EXPECT_TRUE(MapOf([](double, double) { return true; }, round, round, seed).gaps().empty());
    }
  }
}

// One void wherever on the circle it lies, of the same size as one in the middle.
TEST(GapMapTest, AVoidAcrossTheSeamIsOne) {
  constexpr double kRadius = 0.25;
  const GapMap middle = MapOf(Outside(1, 0.5, kRadius), true);
  ASSERT_EQ(middle.gaps().size(), 1);
  EXPECT_NEAR(middle.gap_share(),
              std::numbers::pi * kRadius * kRadius / (kLengthU * kLengthV),
              0.15 * middle.gap_share());
  for (const double u : {0.0, 0.1, 1.9}) {
    SCOPED_TRACE(u);
    const GapMap map = MapOf(Outside(u, 0.5, kRadius), true);
    ASSERT_EQ(map.gaps().size(), 1);
    const DataGap& hole = map.gaps()[0];
    EXPECT_FALSE(hole.at_border);
    EXPECT_NEAR(hole.reach, middle.gaps()[0].reach, 2 * map.side());
    EXPECT_NEAR(map.gap_share(), middle.gap_share(), 0.1 * middle.gap_share());
    EXPECT_EQ(map.GapAt({std::fmod(u + 0.1, kLengthU), 0.5}), 0);
    EXPECT_EQ(map.GapAt({std::fmod(u + 1.9, kLengthU), 0.5}), 0);
    EXPECT_EQ(map.GapAt({std::fmod(u + 1.0, kLengthU), 0.5}), -1);
    EXPECT_FALSE(hole.rim.empty());
    EXPECT_FALSE(hole.shore.empty());
    // Not through the hole: the seam's inner places have no rim.
    for (const size_t r : hole.rim) {
      const Eigen::Vector2d at = map.Centre(hole.places[r]);
      const double du = std::abs(at[0] - u);
      EXPECT_GE(std::hypot(std::min(du, kLengthU - du), at[1] - 0.5), kRadius - 4 * kSpacing);
    }
  }
}

TEST(GapMapTest, WithoutASeamTheSameIsTwoAtTheBorder) {
  const GapMap map = MapOf(Outside(0, 0.5, 0.25), false);
  ASSERT_EQ(map.gaps().size(), 2);
  for (const DataGap& hole : map.gaps()) EXPECT_TRUE(hole.at_border);
  const GapMap round_v = MapOf(Outside(1, 0, 0.25), false, true);
  ASSERT_EQ(round_v.gaps().size(), 1);
  EXPECT_FALSE(round_v.gaps()[0].at_border);
}

TEST(GapMapTest, RoundBothWaysTheCornersAreOnePlace) {
  const GapMap map = MapOf(Outside(0, 0, 0.3), true, true);
  ASSERT_EQ(map.gaps().size(), 1);
  EXPECT_FALSE(map.gaps()[0].at_border);
  for (const double u : {0.05, 1.95})
    for (const double v : {0.05, 0.95}) EXPECT_EQ(map.GapAt({u, v}), 0);
}

// To some hundredths by the chamfer, and a spacing because points lie where chance wants.
TEST(GapMapTest, DistancesGoRoundTheShorterWay) {
  constexpr double kRadius = 0.3;
  for (const double u : {0.0, 0.05, 1.8}) {
    SCOPED_TRACE(u);
    const GapMap map = MapOf(Outside(u, 0.5, kRadius), true);
    ASSERT_EQ(map.gaps().size(), 1);
    const DataGap& hole = map.gaps()[0];
    for (size_t k = 0; k < hole.places.size(); ++k) {
      const Eigen::Vector2d at = map.Centre(hole.places[k]);
      const double du = std::abs(at[0] - u);
      const double inside = kRadius - std::hypot(std::min(du, kLengthU - du), at[1] - 0.5);
      EXPECT_GE(hole.distance[k], 0.92 * inside - map.side());
      EXPECT_LE(hole.distance[k], 1.09 * inside + 3 * kSpacing);
    }
  }
}

// A band all round without points has no border beside it, and two rims.
TEST(GapMapTest, ABandAllRoundIsSurrounded) {
  const Where where = [](double, double v) { return v < 0.3 || v > 0.7; };
  const GapMap map = MapOf(where, true);
  ASSERT_EQ(map.gaps().size(), 1);
  EXPECT_FALSE(map.gaps()[0].at_border);
  EXPECT_NEAR(map.gap_share(), 0.4, 0.04);
  EXPECT_TRUE(MapOf(where, false).gaps()[0].at_border);
}

// The equation knows no seam: the fill of what is moved round is the fill moved round.
TEST(GapMapTest, TheFillStaysBetweenTheRimsValuesAcrossTheSeam) {
  const GapMap map = MapOf(Outside(0, 0.5, 0.3), true);
  ASSERT_EQ(map.gaps().size(), 1);
  const DataGap& hole = map.gaps()[0];
  const auto rims = static_cast<Eigen::Index>(hole.rim.size());
  const Eigen::MatrixXd flat = map.HarmonicFill(hole, Eigen::MatrixXd::Constant(2, rims, 3.5));
  EXPECT_LE((flat.array() - 3.5).abs().maxCoeff(), kIterated);
  // Harmonic itself: v, and u measured from the seam.
  Eigen::MatrixXd rim(2, rims);
  const auto from_seam = [](double u) { return u > kLengthU / 2 ? u - kLengthU : u; };
  for (Eigen::Index r = 0; r < rims; ++r) {
    const Eigen::Vector2d at = map.Centre(hole.places[hole.rim[static_cast<size_t>(r)]]);
    rim.col(r) << from_seam(at[0]), at[1];
  }
  const Eigen::MatrixXd fill = map.HarmonicFill(hole, rim);
  for (size_t k = 0; k < hole.places.size(); ++k) {
    const Eigen::Vector2d at = map.Centre(hole.places[k]);
    EXPECT_NEAR(fill(0, static_cast<Eigen::Index>(k)), from_seam(at[0]), kIterated);
    EXPECT_NEAR(fill(1, static_cast<Eigen::Index>(k)), at[1], kIterated);
  }
}

// Points even on a sphere, outside a disc about its first pole.
GapMap SphereMap(Eigen::Index count, double hole, bool with_poles, std::uint64_t seed) {
  const TurnedShape sphere = WholeSphere();
  const TurnedPoints cloud = PointsOn(sphere, count, 0, seed);
  const double around = 2 * std::numbers::pi * 2 / std::numbers::pi;  // mean radius 2/π
  auto data = std::make_shared<FittingData>();
  data->parameters.resize(2, count);
  Eigen::Index kept = 0;
  for (Eigen::Index k = 0; k < count; ++k) {
    if (cloud.parameters(1, k) < hole) continue;
    data->parameters.col(kept++) << cloud.parameters(0, k) / (2 * std::numbers::pi) * around,
        cloud.parameters(1, k);
  }
  data->parameters.conservativeResize(2, kept);
  data->values = Eigen::MatrixXd::Zero(3, kept);
  const FittingProblem problem(PeriodicUniformKnots(3, 12, 0, around),
                               SplineBasis::Uniform(3, 10, 0, std::numbers::pi),
                               std::move(data),
                               1e-4);
  Poles poles;
  poles.start = poles.end = PoleKind::kSmooth;
  return {with_poles ? problem.WithPoles(poles) : problem, kept, sphere.SpacingOf(count)};
}

// Towards a pole few points fill a row of the rectangle that is as long as the others.
TEST(GapMapTest, PolesAreNoVoids) {
  int without = 0;
  for (const Eigen::Index count : {2000, 8000, 30000}) {
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      SCOPED_TRACE(std::to_string(count) + " points, seed " + std::to_string(seed));
      EXPECT_TRUE(SphereMap(count, 0, true, seed).gaps().empty());
      without += SphereMap(count, 0, false, seed).gaps().empty() ? 0 : 1;
    }
  }
  EXPECT_GE(without, 10) << "the case is meant to look empty to who knows of no poles";
}

TEST(GapMapTest, AHoleAboutAPoleIsAVoid) {
  for (const double spacings : {8.0, 20.0}) {
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      SCOPED_TRACE(std::to_string(spacings) + " spacings, seed " + std::to_string(seed));
      const double radius = spacings * WholeSphere().SpacingOf(8000);
      const GapMap map = SphereMap(8000, radius, true, seed);
      const int number = map.GapAt({1, 0});
      ASSERT_GE(number, 0);
      const DataGap& hole = map.gaps()[static_cast<size_t>(number)];
      EXPECT_TRUE(hole.at_border);
      for (const double u : {0.0, 0.5, 2.0, 3.5}) EXPECT_EQ(map.GapAt({u, 0.5 * radius}), number);
      EXPECT_NEAR(hole.reach, radius, 0.25 * radius);
    }
  }
}

}  // namespace batten::internal::gap_map_test
