// SPDX-License-Identifier: MIT
// Whether errors of fitted lines and circles are what their standard deviations say.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <variant>

#include "batten/fitting/fit_primitive.h"
#include "primitive_clouds.h"

namespace batten::internal::curve_accuracy_test {

struct Case {
  bool plane, bent;
  std::optional<Loss> loss;
  double sweep = 2 * std::numbers::pi;
};

// Errors over standard deviations, by number: direction or axis, place, radius.
Eigen::Vector3d OffBy(const PrimitiveFit& fit, const Place& place) {
  const PrimitiveSummary& s = *fit.report.geometry.primitive;
  const PrimitiveAccuracy& a = *s.accuracy;
  const auto tilt = [&](const Eigen::Vector3d& found, const Eigen::Vector3d& truth) {
    return found.cross(truth).dot(a.frame_x);  // of the two turns one
  };
  if (s.direction) {
    const Eigen::Vector3d truth = place.turn.col(0);
    const double turn = s.direction->cross(truth).dot(s.direction->cross(a.frame_x));
    const Eigen::Vector3d off = *s.point - place.shift;
    const Eigen::Vector3d beside = off - off.dot(truth) * truth;
    return {turn / a.standard_deviations[0], beside.dot(a.frame_x) / a.Deviation("point"), 0};
  }
  const bool plane = a.names.size() == 3;
  const Eigen::Vector3d off = *s.center - place.shift;
  return {plane ? 0 : tilt(*s.axis, place.turn.col(2)) / a.standard_deviations[1],
          off[0] / a.standard_deviations[plane ? 0 : 2],
          (*s.radius - place.scale) / a.Deviation("radius")};
}

void ExpectCalibrated(const Case& c, unsigned seed, int draws) {
  SCOPED_TRACE("seed " + std::to_string(seed) + (c.bent ? " circle" : " line") +
               (c.plane ? " in the plane" : " in space") + (c.loss ? " robust" : ""));
  RandomSplines random(seed);
  Noise noise(seed);
  Eigen::Vector3d squares = Eigen::Vector3d::Zero();
  Eigen::Vector3i outside = Eigen::Vector3i::Zero();
  for (int draw = 0; draw < draws; ++draw) {
    Place place = RandomPlace(random, c.plane, 3);
    place.scale = random.Logarithmic(0.1, 10);
    Eigen::Matrix3Xd points = c.bent ? ArcPoints(100, c.sweep) : LinePoints(100, 1);
    noise.AddTo(points, 2e-3, c.plane);
    const PrimitiveFit fit =
        FitPrimitive(Cloud(place(points), c.plane),
                     Options(c.bent ? PrimitiveKind::kCircle : PrimitiveKind::kLine, c.loss));
    const Eigen::Vector3d off = OffBy(fit, place);
    squares += off.cwiseAbs2() / draws;
    outside += (off.array().abs() > 3).cast<int>().matrix();
  }
  EXPECT_LE(outside.maxCoeff(), std::max(3, draws / 100));
  // The mean square of normal errors spreads by √(2 / draws) about one.
  for (const double square : squares) {
    if (square == 0) continue;  // no such number
    EXPECT_LE(square, 1.1 + 3 * std::sqrt(2.0 / draws));
    EXPECT_GE(square, 0.85 - 3 * std::sqrt(2.0 / draws));
  }
}

void ExpectAllCalibrated(unsigned seed, int draws) {
  for (const bool plane : {true, false}) {
    for (const bool bent : {true, false}) {
      ExpectCalibrated({plane, bent, {}}, ++seed, draws);
      ExpectCalibrated({plane, bent, Loss::kHuber}, ++seed, draws);
      if (bent) ExpectCalibrated({plane, bent, {}, 40 * kDegree}, ++seed, draws);
    }
  }
}

TEST(CurveAccuracyTest, ErrorsAreWithinThreeStandardDeviations) { ExpectAllCalibrated(0, 100); }

TEST(LongCurveAccuracyTest, ErrorsAreWithinThreeStandardDeviations) {
  ExpectAllCalibrated(50, 500);
}

TEST(CurveAccuracyTest, ShortArcsHaveRadiiWithoutLimit) {
  Noise noise(20);
  Eigen::Matrix3Xd points = ArcPoints(100, 2 * kDegree);
  noise.AddTo(points, 1e-3, false);
  const PrimitiveFit fit = FitPrimitive(Cloud(points, false), Options(PrimitiveKind::kCircle));
  EXPECT_GT(fit.report.geometry.primitive->accuracy->Deviation("radius"),
            0.3 * *fit.report.geometry.primitive->radius);
  EXPECT_FALSE(fit.report.warnings.empty());
}

// Two points, three points: they fit exactly, and nothing says how well.
TEST(CurveAccuracyTest, PointsWithoutAnyToSpareTellNothing) {
  const PrimitiveFit circle =
      FitPrimitive(Cloud(ArcPoints(3, 2), false), Options(PrimitiveKind::kCircle));
  EXPECT_TRUE(std::isinf(circle.report.geometry.primitive->accuracy->Deviation("radius")));
  const PrimitiveFit line =
      FitPrimitive(Cloud(LinePoints(2, 1), false), Options(PrimitiveKind::kLine));
  EXPECT_TRUE(std::isinf(line.report.geometry.primitive->accuracy->Deviation("direction")));
}

}  // namespace batten::internal::curve_accuracy_test
