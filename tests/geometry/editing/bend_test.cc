// SPDX-License-Identifier: MIT
#include "batten/geometry/bend.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "batten/geometry/arc_length.h"
#include "batten/geometry/reverse.h"
#include "law_cases.h"
#include "shape_edits.h"
#include "tolerances.h"

namespace batten::internal::bend_test {

// The map in the plane, written down once more: about the origin from (r, 0) on, up the y-axis.
Eigen::Vector2d Image(const Eigen::Vector2d& p, double radius, double length) {
  if (p.y() <= 0) return p;
  const double angle = std::min(p.y(), length) / radius, behind = std::max(0.0, p.y() - length);
  return {p.x() * std::cos(angle) - behind * std::sin(angle),
          p.x() * std::sin(angle) + behind * std::cos(angle)};
}

constexpr double kRadius = 5, kLength = 6, kTolerance = 1e-5;

CircleBend Upwards() { return {{kRadius, 0, 0}, {0, 0, 0}, {0, 0, 1}, kLength}; }

TEST(BendTest, ALineBecomesAnArcOfItsLengthAndWhatIsBehindGoesOnStraight) {
  const NurbsCurve<2> line(SplineBasis::Uniform(3, 4, 0, 1),
                           Eigen::Matrix2Xd{{kRadius, kRadius, kRadius, kRadius}, {-1, 2, 5, 8}});
  const auto [bent, error] = Bent(line, Upwards(), kTolerance);
  EXPECT_LE(error, kTolerance);
  EXPECT_NEAR(ArcLength(bent), 9, 10 * kTolerance);
  for (int k = 0; k <= 900; ++k) {
    const double y = -1 + k / 100.;
    const Eigen::Vector2d at = bent.At(k / 900.);
    if (y > 0 && y < kLength) {
      EXPECT_NEAR(at.norm(), kRadius, 2 * kTolerance);
    }
    EXPECT_LE((at - Image({kRadius, y}, kRadius, kLength)).norm(), 2 * kTolerance);
  }
}

TEST(BendTest, PointsOfRandomCurvesGoToTheirImages) {
  int bent_to_tolerance = 0, all = 0;
  ForRandomCurves<2>(
      [&](const NurbsCurve<2>& unit, RandomSplines&) {
        const NurbsCurve<2> curve(unit.basis(),
                                  unit.control_points().colwise() + Eigen::Vector2d(kRadius, 0.5),
                                  unit.weights());
        const auto [bent, error] = Bent(curve, Upwards(), 1e-3);
        ++all;
        if (error > 1e-3)
          return;  // told: crossings closer than the samples, or very uneven weights
        ++bent_to_tolerance;
        for (int k = 0; k <= 100; ++k) {
          const SplineBasis& basis = curve.basis();
          const double u = basis.lower() + (basis.upper() - basis.lower()) * k / 100;
          EXPECT_LE((bent.At(u) - Image(curve.At(u), kRadius, kLength)).norm(), 2e-3);
        }
      },
      2,
      5);
  EXPECT_GE(bent_to_tolerance, 9 * all / 10);
}

TEST(BendTest, ASheetBecomesACylinderWithKnotsInTheBentDirectionOnly) {
  Eigen::Matrix3Xd net(3, 16);
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j) net.col(4 * i + j) << kRadius, 2 * i, j;
  }
  const SplineBasis basis = SplineBasis::Uniform(3, 4, 0, 1);
  const auto [bent, error] = Bent(NurbsSurface(basis, basis, net), Upwards(), kTolerance);
  EXPECT_LE(error, kTolerance);
  EXPECT_EQ(bent.basis_v(), basis);
  for (int k = 0; k <= 50; ++k) {
    for (int l = 0; l <= 5; ++l) {
      const Eigen::Vector3d at = bent.At(k / 50., l / 5.);
      EXPECT_NEAR(at.head<2>().norm(), kRadius, 2 * kTolerance);
      EXPECT_NEAR(at.z(), 3. * l / 5, kRounding * 10);
    }
  }
}

// Off the radius the image breaks where the bend begins and ends: knots stand there.
TEST(BendTest, ACurveBreaksWhereItsImageDoes) {
  const NurbsCurve<2> slanted(SplineBasis::Uniform(3, 4, 0, 1),
                              Eigen::Matrix2Xd{{7, 6, 5, 4}, {-2, 2, 6, 10}});
  const auto [bent, error] = Bent(slanted, Upwards(), kTolerance);
  EXPECT_LE(error, kTolerance);
  EXPECT_LE(bent.basis().size(), 60);
  for (int k = 0; k <= 1000; ++k) {
    EXPECT_LE((bent.At(k / 1000.) - Image(slanted.At(k / 1000.), kRadius, kLength)).norm(),
              2 * kTolerance);
  }
}

// A plate whose rows run along the bend, its heights above the circle as given.
template <typename Height>
NurbsSurface Plate(int size, const Height& height) {
  Eigen::Matrix3Xd net(3, size * size);
  for (int i = 0; i < size; ++i) {
    for (int j = 0; j < size; ++j) {
      net.col(size * i + j) << kRadius + height(i, j), 9. * i / (size - 1) - 1, 3. * j / (size - 1);
    }
  }
  const SplineBasis basis = SplineBasis::Uniform(3, size, 0, 1);
  return NurbsSurface(basis, basis, net);
}

// Lines across the bend turn as a whole: their images need no knots, however rough they are; and
// the lines at which the bend begins and ends are knots.
TEST(BendTest, WhatDoesNotBendGetsNoKnots) {
  RandomSplines random(7);
  const auto peak = Plate(4, [](int i, int j) { return i == 1 && j == 2 ? 0.1 : 0; });
  const auto rough = Plate(7, [&](int, int) { return random.Real(-0.3, 0.3); });
  for (const NurbsSurface& plate : {peak, rough, Swapped(rough)}) {
    const bool swapped = plate == Swapped(rough);
    const auto [bent, error] = Bent(plate, Upwards(), kTolerance);
    EXPECT_LE(error, kTolerance);
    EXPECT_EQ(swapped ? bent.basis_u() : bent.basis_v(), plate.basis_v());
    EXPECT_LE(swapped ? bent.size_v() : bent.size_u(), 60);
    for (int k = 0; k <= 150; ++k) {
      for (int l = 0; l <= 20; ++l) {
        const Eigen::Vector3d at = bent.At(k / 150., l / 20.), old = plate.At(k / 150., l / 20.);
        const Eigen::Vector2d image = Image(old.head<2>(), kRadius, kLength);
        EXPECT_LE((at - Eigen::Vector3d(image.x(), image.y(), old.z())).norm(), 2 * kTolerance);
      }
    }
  }
}

TEST(BendTest, WhatLiesBeforeStays) {
  const NurbsCurve<3> curve(SplineBasis::Uniform(2, 3, 0, 1),
                            Eigen::Matrix3Xd{{5, 6, 7}, {-3, -2, -1}, {0, 1, 0}});
  const auto [bent, error] = Bent(curve, Upwards(), kTolerance);
  EXPECT_EQ(bent, curve);
  EXPECT_EQ(error, 0);
}

TEST(BendTest, RefusesWhatItCannotDo) {
  const NurbsCurve<2> curve(SplineBasis::Uniform(1, 2, 0, 1), Eigen::Matrix2Xd{{-1, -1}, {0, 4}});
  const auto refusal = [&](const CircleBend& bend, double tolerance = 1e-3) {
    return RefusalOf([&] { Bent(curve, bend, tolerance); });
  };
  CircleBend bend = Upwards();
  EXPECT_THAT(refusal(bend),
              testing::AllOf(testing::HasSubstr("reaches the axis"),
                             testing::HasSubstr("lies 1 beyond it")));
  EXPECT_THAT(refusal(bend, 0), testing::HasSubstr("tolerance 0 is not positive"));
  bend.length = 32;
  EXPECT_THAT(refusal(bend), testing::HasSubstr("more than once round the circle, 31.4159"));
  bend = Upwards();
  bend.axis = {1, 0, 0};
  EXPECT_THAT(refusal(bend), testing::HasSubstr("lies on the axis"));
  bend.axis = {0, 1, 0};
  EXPECT_THAT(refusal(bend), testing::HasSubstr("not along z"));
  bend.axis = {0, 0, 0};
  EXPECT_THAT(refusal(bend), testing::HasSubstr("the axis has no length"));
}

}  // namespace batten::internal::bend_test
