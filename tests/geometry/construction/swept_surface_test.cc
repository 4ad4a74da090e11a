// SPDX-License-Identifier: MIT
#include "batten/geometry/swept_surface.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "batten/geometry/closure.h"
#include "batten/geometry/make_curve.h"
#include "batten/geometry/make_surface.h"
#include "construction_cases.h"
#include "refusal.h"
#include "tolerances.h"

namespace batten::internal::swept_surface_test {

using ::testing::HasSubstr;

// A space curve that bends and turns everywhere.
NurbsCurve<3> Spatial() {
  return Cubic({{0, 0, 0}, {0, 0, 4}, {3, 1, 8}, {8, 5, 9}, {12, 5, 5}, {14, 0, 0}});
}

// The normal's own differential equation, r' = -(r·t')t, by Runge and Kutta's steps.
std::vector<Eigen::Matrix3d> IntegratedFrames(const NurbsCurve<3>& curve, int places, int each) {
  const auto tangent = [&](double u) { return curve.JetAt(u).first.normalized().eval(); };
  const auto slope = [&](double u, const Eigen::Vector3d& normal) {
    const CurveJet<3> jet = curve.JetAt(u);
    const Eigen::Vector3d t = jet.first.normalized();
    const Eigen::Vector3d bend = (jet.second - t * t.dot(jet.second)) / jet.first.norm();
    return Eigen::Vector3d(-normal.dot(bend) * t);
  };
  const double h = 1.0 / (places * each);
  Eigen::Vector3d normal = tangent(0).unitOrthogonal();
  const auto axes = [&](double u) {
    Eigen::Matrix3d matrix;
    matrix << normal, tangent(u).cross(normal), tangent(u);
    return matrix;
  };
  const Eigen::Matrix3d first = axes(0);
  std::vector<Eigen::Matrix3d> turns = {Eigen::Matrix3d::Identity()};
  for (int k = 0; k < places * each; ++k) {
    const double u = k * h;
    const Eigen::Vector3d a = slope(u, normal), b = slope(u + h / 2, normal + h / 2 * a);
    const Eigen::Vector3d c = slope(u + h / 2, normal + h / 2 * b),
                          d = slope(u + h, normal + h * c);
    normal += h / 6 * (a + 2 * b + 2 * c + d);
    if ((k + 1) % each == 0) turns.push_back(axes(u + h) * first.transpose());
  }
  return turns;
}

TEST(SweepTest, KeepsTheToleranceEverywhere) {
  const NurbsCurve<3> path = Spatial();
  const NurbsCurve<3> profile = MakeArc(Frame(path.At(0), path.JetAt(0).first), 0.8);
  constexpr int kPlaces = 500, kEach = 20;
  const std::vector<Eigen::Matrix3d> turns = IntegratedFrames(path, kPlaces, kEach);
  for (const double tolerance : {1e-2, 1e-4, 1e-6, 1e-8}) {
    const SweptSurface sweep = Sweep(profile, path, {.tolerance = tolerance});
    double worst = 0;
    for (int k = 0; k <= kPlaces; ++k) {
      const double v = double(k) / kPlaces;
      for (const double u : {0.0, 0.13, 0.5, 0.77}) {
        const Eigen::Vector3d exact = path.At(v) + turns[k] * (profile.At(u) - path.At(0));
        worst = std::max(worst, (sweep.surface.At(u, v) - exact).norm());
      }
    }
    EXPECT_LE(worst, tolerance);
    EXPECT_LE(sweep.error, tolerance);
    EXPECT_TRUE(sweep.surface.At(0.3, 0) == profile.At(0.3));
    EXPECT_GE(worst, tolerance * 1e-3) << "finer than asked for by far";
  }
}

TEST(SweepTest, AlongAnArcItIsTheSurfaceOfRevolution) {
  const NurbsCurve<3> path = MakeArc(Frame(), 5, {0, 1.9});
  const NurbsCurve<3> profile = MakeArc(Frame({5.3, 0, 0.2}, {0, 1, 0}), 1);
  const SweptSurface sweep = Sweep(profile, path, {.tolerance = 1e-7});
  for (int k = 0; k <= 300; ++k) {
    const double v = k / 300.0;
    const Eigen::Vector3d on_path = path.At(v);
    const Eigen::Matrix3d turn =
        Eigen::AngleAxisd(std::atan2(on_path.y(), on_path.x()), Eigen::Vector3d::UnitZ()).matrix();
    for (const double u : {0.0, 0.4, 0.8}) {
      EXPECT_LE((sweep.surface.At(u, v) - turn * profile.At(u)).norm(), 1e-7);
    }
  }
}

TEST(SweepTest, AlongASegmentItIsTheExtrusion) {
  const NurbsCurve<3> profile = Cubic({{0, 0, 0}, {1, 1, 0}, {2, -1, 0}, {3, 0, 0}});
  const SweptSurface sweep = Sweep(profile, MakeLine<3>({1, 1, 1}, {2, 3, 9}), {.tolerance = 1e-9});
  for (const double u : {0.0, 0.3, 1.0}) {
    for (const double v : {0.0, 0.4, 1.0}) {
      EXPECT_LE((sweep.surface.At(u, v) - (profile.At(u) + v * Eigen::Vector3d(1, 2, 8))).norm(),
                100 * kRounding);
    }
  }
}

TEST(SweepTest, ClosedTrajectoriesCloseSmoothlyWithTheirTurnSpread) {
  // A closed curve that leaves the plane: its frame comes back turned.
  const std::vector<double> breaks = {0, 1, 2, 3, 4, 5, 6, 7, 8};
  std::vector<double> knots;
  for (int k = -3; k <= 11; ++k) knots.push_back(k);
  Eigen::Matrix3Xd points(3, 11);
  for (int i = 0; i < 11; ++i) {
    const double a = 2 * kPi * (i % 8) / 8;
    points.col(i) << 10 * std::cos(a), 10 * std::sin(a), 3 * std::sin(2 * a) + 2 * std::cos(3 * a);
  }
  const NurbsCurve<3> path(SplineBasis::Periodic(3, knots), points);
  const Eigen::Vector3d start = path.At(0), tangent = path.JetAt(0).first;
  const NurbsCurve<3> profile = MakeArc(Frame(start, tangent), 1, {0, 2});
  const SweptSurface sweep = Sweep(profile, path, {.tolerance = 1e-5});
  EXPECT_GT(std::abs(sweep.closing), 0.01);
  EXPECT_TRUE(Closed(sweep.surface, Direction::kV, 0));
  EXPECT_GE(SeamContinuity(sweep.surface, Direction::kV, 1e-6).value_or(-1), 1);
  // Still a pipe: every section is as far from the path as the profile.
  for (int k = 0; k <= 400; ++k) {
    const double v = 8.0 * k / 400;
    EXPECT_NEAR((sweep.surface.At(0.37, v) - path.At(v)).norm(), 1, 1e-5);
    EXPECT_NEAR(
        (sweep.surface.At(0.37, v) - path.At(v)).dot(path.JetAt(v).first.normalized()), 0, 1e-5);
  }
  EXPECT_THAT(RefusalOf([&] { Sweep(profile, path, {.tolerance = 1e-5, .twist = 1}); }),
              HasSubstr("only whole turns"));
}

TEST(SweepTest, TwistTurnsTheLastSection) {
  const NurbsCurve<3> profile = MakeLine<3>({1, 0, 0}, {2, 0, 0});
  const SweptSurface sweep =
      Sweep(profile, MakeLine<3>({0, 0, 0}, {0, 0, 10}), {.tolerance = 1e-6, .twist = kPi / 2});
  EXPECT_LE((sweep.surface.At(0, 1) - Eigen::Vector3d(0, 1, 10)).norm(), 1e-6);
  const double turned = kPi / 4;
  EXPECT_LE(
      (sweep.surface.At(1, 0.5) - Eigen::Vector3d(2 * std::cos(turned), 2 * std::sin(turned), 5))
          .norm(),
      1e-6);
}

TEST(SweepTest, FarAwayAndSmall) {
  for (const auto& [scale, shift, slack] :
       {std::tuple(1.0, 5e6, 1e-8), std::tuple(1e-6, 0.0, 0.0)}) {
    const Eigen::Matrix4d map = Translation({shift, shift, 0}) * Scaling(scale);
    const NurbsCurve<3> path = Transformed(Spatial(), map);
    const NurbsCurve<3> profile = Transformed(MakeArc(Frame({0, 0, 0}, {0, 0, 1}), 0.8), map);
    const double tolerance = 1e-5 * scale;
    const SweptSurface sweep = Sweep(profile, path, {.tolerance = tolerance});
    const SweptSurface plain =
        Sweep(MakeArc(Frame({0, 0, 0}, {0, 0, 1}), 0.8), Spatial(), {.tolerance = 1e-5});
    EXPECT_LE(LargestDifference(sweep.surface, Transformed(plain.surface, map)),
              2 * tolerance + slack);
  }
}

TEST(SweepTest, KinksStillnessAndFoldsAreRefusedWithThePlace) {
  const NurbsCurve<3> profile = MakeArc(Frame({0, 0, 0}, {1, 0, 0}), 1);
  Eigen::Matrix3Xd corner(3, 3);
  corner << 0, 5, 5, 0, 0, 5, 0, 0, 0;
  const NurbsCurve<3> bent(SplineBasis(1, {0, 0, 0.5, 1, 1}), corner);
  EXPECT_THAT(RefusalOf([&] { Sweep(profile, bent, {.tolerance = 1e-3}); }),
              HasSubstr("a kink of 90 degrees at its parameter 0.5, at (5, 0, 0)"));
  Eigen::Matrix3Xd square(3, 5);
  square << 0, 4, 4, 0, 0, 0, 0, 4, 4, 0, 0, 0, 0, 0, 0;
  const NurbsCurve<3> tight = MakeArc(Frame({0, 0.5, 0}, {0, 0, 1}, {0, -1, 0}), 0.5, {0, 2});
  EXPECT_THAT(RefusalOf([&] { Sweep(profile, tight, {.tolerance = 1e-3}); }),
              HasSubstr("whose radius is 0.5"));
  EXPECT_THAT(RefusalOf([&] { Sweep(profile, Spatial(), {}); }), HasSubstr("tolerance = 0"));
  const NurbsCurve<3> still(SplineBasis::Uniform(3, 4, 0, 1), Eigen::Matrix3Xd::Ones(3, 4));
  EXPECT_THAT(RefusalOf([&] { Sweep(profile, still, {.tolerance = 1e-3}); }),
              HasSubstr("is a point"));
  const NurbsCurve<3> cusp = Cubic({{0, 0, 0}, {1, 1, 0}, {0, 1, 0}, {1, 0, 0}});
  const NurbsCurve<3> resting = Cubic({{0, 0, 0}, {0, 0, 0}, {0, 0, 5}, {0, 0, 9}});
  EXPECT_THAT(RefusalOf([&] { Sweep(profile, resting, {.tolerance = 1e-3}); }),
              HasSubstr("no tangent at its parameter 0, at (0, 0, 0)"));
  EXPECT_NE(RefusalOf([&] { Sweep(profile, cusp, {.tolerance = 1e-3}); }), "accepted");
}

}  // namespace batten::internal::swept_surface_test
