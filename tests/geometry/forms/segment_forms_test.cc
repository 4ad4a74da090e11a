// SPDX-License-Identifier: MIT
#include "batten/geometry/segment_forms.h"

#include <gtest/gtest.h>

#include "batten/geometry/knot_vectors.h"
#include "batten/geometry/nurbs_curve.h"
#include "random_splines.h"
#include "refusal.h"
#include "tolerances.h"

namespace batten::internal::segment_forms_test {

Eigen::Matrix3Xd RandomPoints(RandomSplines& random, int count) {
  Eigen::Matrix3Xd points(3, count);
  for (double& x : points.reshaped()) x = random.Real(-1, 1);
  return points;
}

TEST(SegmentFormsTest, HermiteFormsHaveTheirEnds) {
  RandomSplines random(21);
  for (int k = 0; k < 100; ++k) {
    const Eigen::Matrix3Xd x = RandomPoints(random, 6);
    const BezierCurve<3> cubic = ToBezier(CubicHermite<3>{x.col(0), x.col(1), x.col(2), x.col(3)});
    EXPECT_LE((cubic.Derivatives(0, 1) - x.leftCols(2)).norm(), kRounding);
    EXPECT_LE((cubic.Derivatives(1, 1) - x.middleCols(2, 2)).norm(), kRounding);
    const BezierCurve<3> quintic =
        ToBezier(QuinticHermite<3>{x.col(0), x.col(1), x.col(2), x.col(3), x.col(4), x.col(5)});
    EXPECT_LE((quintic.Derivatives(0, 2) - x.leftCols(3)).norm(), kRounding * 10);
    EXPECT_LE((quintic.Derivatives(1, 2) - x.rightCols(3)).norm(), kRounding * 10);
  }
}

// The three forms of one cubic, round and back; the B-spline is that of uniform knots.
TEST(SegmentFormsTest, ThreeFormsOfOneCubic) {
  RandomSplines random(22);
  for (int k = 0; k < 100; ++k) {
    const Eigen::Matrix3Xd d = RandomPoints(random, 4);
    const BezierCurve<3> curve = ToBezier(UniformCubicSegment<3>{d});
    const NurbsCurve<3> spline(UniformKnots(3, 4, 0, 1), d);
    for (const double t : {0.0, 0.2, 0.7, 1.0}) {
      EXPECT_LE((curve.At(t) - spline.At(t)).norm(), kRounding);
    }
    EXPECT_LE((UniformCubicSegmentOf(curve).control_points - d).norm(), kRounding);
    const BezierCurve<3> again = ToBezier(CubicHermiteOf(curve));
    EXPECT_LE((again.control_points() - curve.control_points()).norm(), kRounding);
    const BezierCurve<3> quintic = Elevated(curve, 2);
    const BezierCurve<3> back = ToBezier(QuinticHermiteOf(quintic));
    EXPECT_LE((back.control_points() - quintic.control_points()).norm(), kRounding);
  }
}

TEST(SegmentFormsTest, OtherDegreesAndWeightsAreRefused) {
  RandomSplines random(23);
  const BezierCurve<3> quartic(RandomPoints(random, 5));
  EXPECT_NE(RefusalOf([&] { CubicHermiteOf(quartic); }), "accepted");
  EXPECT_NE(RefusalOf([&] { QuinticHermiteOf(quartic); }), "accepted");
  const BezierCurve<3> rational(RandomPoints(random, 4), Eigen::Vector4d(1, 2, 1, 1));
  EXPECT_NE(RefusalOf([&] { UniformCubicSegmentOf(rational); }), "accepted");
}

}  // namespace batten::internal::segment_forms_test
