// SPDX-License-Identifier: MIT
// Colours of deviations: both signs alike, and apart for every kind of eye.
#include "batten/io/deviation_colours.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

namespace batten::internal::deviation_colours_test {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

Eigen::Vector3d LinearOf(const Rgb& colour) {
  Eigen::Vector3d linear;
  for (int k = 0; k < 3; ++k) {
    const double value = colour[k] / 255.0;
    linear[k] = value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4);
  }
  return linear;
}

// CIELAB of linear sRGB under D65.
Eigen::Vector3d LabOf(const Eigen::Vector3d& linear) {
  const Eigen::Matrix3d to_xyz{{0.4124564, 0.3575761, 0.1804375},
                               {0.2126729, 0.7151522, 0.0721750},
                               {0.0193339, 0.1191920, 0.9503041}};
  Eigen::Array3d xyz = (to_xyz * linear).array() / (to_xyz * Eigen::Vector3d::Ones()).array();
  for (double& x : xyz) x = x > 216.0 / 24389 ? std::cbrt(x) : (24389.0 / 27 * x + 16) / 116;
  return {116 * xyz[1] - 16, 500 * (xyz[0] - xyz[1]), 200 * (xyz[1] - xyz[2])};
}

// What people without cones of one kind see: linear sRGB [Viénot, Brettel & Mollon 1999].
Eigen::Matrix3d Protan() {
  return Eigen::Matrix3d{{0.11238, 0.88762, 0}, {0.11238, 0.88762, 0}, {0.00401, -0.00401, 1}};
}
Eigen::Matrix3d Deutan() {
  return Eigen::Matrix3d{{0.29275, 0.70725, 0}, {0.29275, 0.70725, 0}, {-0.02234, 0.02234, 1}};
}

TEST(DeviationColoursTest, GetDarkerTowardsBothEndsAlike) {
  double last_below = 200, last_above = 200;
  for (double d = 0; d <= 1.05; d += 0.05) {
    const double below = LabOf(LinearOf(DeviationColour(-d, 1)))[0];
    const double above = LabOf(LinearOf(DeviationColour(d, 1)))[0];
    EXPECT_LT(below, last_below) << d;
    EXPECT_LT(above, last_above) << d;
    EXPECT_NEAR(below, above, 6) << d;  // of 100: a step that is hardly seen on large areas
    last_below = below;
    last_above = above;
  }
}

TEST(DeviationColoursTest, SignsStayApartForEveryEye) {
  for (const Eigen::Matrix3d& eye :
       {Eigen::Matrix3d(Eigen::Matrix3d::Identity()), Protan(), Deutan()}) {
    for (const double d : {0.25, 0.5, 0.75, 1.0, 2.0}) {
      const Eigen::Vector3d below = LabOf(eye * LinearOf(DeviationColour(-d, 1)));
      const Eigen::Vector3d above = LabOf(eye * LinearOf(DeviationColour(d, 1)));
      EXPECT_GT((below - above).norm(), 25) << d;  // 2.3 is just noticeable
      const Eigen::Vector3d unknown = LabOf(eye * LinearOf(DeviationColour(kNan, 1)));
      EXPECT_GT((below - unknown).norm(), 20) << d;
      EXPECT_GT((above - unknown).norm(), 20) << d;
    }
    EXPECT_GT((LabOf(eye * LinearOf(DeviationColour(0, 1))) -
               LabOf(eye * LinearOf(DeviationColour(kNan, 1))))
                  .norm(),
              20);
  }
}

TEST(DeviationColoursTest, AreBlueBelowGreyOnTheSurfaceAndRedAbove) {
  EXPECT_EQ(DeviationColour(0, 0.3), Rgb(221, 221, 221));
  EXPECT_EQ(DeviationColour(-0.3, 0.3), Rgb(59, 76, 192));
  EXPECT_EQ(DeviationColour(0.3, 0.3), Rgb(180, 4, 38));
  const double beyond = std::nextafter(0.3, 1.0);
  EXPECT_EQ(DeviationColour(beyond, 0.3), DeviationColour(HUGE_VAL, 0.3));
  EXPECT_EQ(DeviationColour(-beyond, 0.3), DeviationColour(-HUGE_VAL, 0.3));
  EXPECT_NE(DeviationColour(beyond, 0.3), DeviationColour(0.3, 0.3));
  const RgbColumns all = DeviationColours(Eigen::Vector3d(-0.3, kNan, 0), 0.3);
  EXPECT_EQ(all.col(1), DeviationColour(kNan, 0.3));
  EXPECT_EQ(all.col(2), Rgb(221, 221, 221));
  EXPECT_THROW(DeviationColour(0, 0), std::invalid_argument);
  EXPECT_THROW(DeviationColour(0, kNan), std::invalid_argument);
}

TEST(DeviationColoursTest, TheRangeIsARoundNumberThatMostAreWithin) {
  Eigen::VectorXd deviations = Eigen::VectorXd::LinSpaced(1001, -0.037, 0.037);
  EXPECT_EQ(DeviationRange(deviations), 0.05);
  deviations[500] = kNan;
  deviations[0] = 1e9;  // one stray point
  EXPECT_EQ(DeviationRange(deviations), 0.05);
  EXPECT_EQ(DeviationRange(Eigen::Vector2d(2e-5, 2e-5)), 2e-5);
  EXPECT_EQ(DeviationRange(Eigen::Vector2d(2.1e7, -2.1e7)), 5e7);
  EXPECT_EQ(DeviationRange(Eigen::Vector2d(0, kNan)), 1);
  EXPECT_EQ(DeviationRange(Eigen::VectorXd()), 1);
}

}  // namespace batten::internal::deviation_colours_test
