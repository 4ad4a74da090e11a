// SPDX-License-Identifier: MIT
#include "batten/geometry/aligned_curves.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "batten/geometry/make_curve.h"
#include "batten/geometry/reverse.h"
#include "construction_cases.h"

namespace batten::internal::aligned_curves_test {

using Curves = std::vector<NurbsCurve<3>>;

TEST(AlignedTest, FindsTurnedAndShiftedCopiesAgain) {
  for (int seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    // A closed curve without symmetry, and itself moved, begun elsewhere, turned round.
    NurbsCurve<3> curve = random.Curve<3>(3, false, {.most_spans = 9, .periodic = true});
    const NurbsCurve<3> moved = Transformed(curve, Translation({0, 0, 3}));
    const SplineBasis& basis = moved.basis();
    const double period = basis.upper() - basis.lower(), shift = random.Real(0.1, 0.9) * period;
    Eigen::Matrix3Xd points = moved.control_points();
    std::vector<double> knots = basis.knots();
    const NurbsCurve<3> turned = random.Coin() ? Reversed(moved) : moved;
    const Curves pair = {curve, turned};
    const AlignedCurves aligned = Aligned(pair);
    EXPECT_EQ(aligned.changes[1].reversed, !(turned == moved));
    for (int k = 0; k <= 30; ++k) {
      const Eigen::Vector3d apart = AtShare(aligned.curves[1], k / 30.0) - AtShare(curve, k / 30.0);
      EXPECT_LE((apart - Eigen::Vector3d(0, 0, 3)).norm(), 1e-5) << shift;
    }
  }
}

TEST(AlignedTest, WhatIsWellBegunStaysBitByBit) {
  Curves circles;
  for (int k = 0; k < 4; ++k)
    circles.push_back(MakeArc(Frame({0.1 * k, 0, double(k)}, {0, 0.1, 1}), 1 + 0.3 * k));
  EXPECT_EQ(Aligned(circles).curves, circles);
}

}  // namespace batten::internal::aligned_curves_test
