// SPDX-License-Identifier: MIT
// Lines and circles: exact where the points are, the least sum of squares where they are not, and
// the same shape in every place, attitude and unit.
#include "batten/fitting/fit_primitive.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <variant>
#include <vector>

#include "cases.h"
#include "primitive_clouds.h"
#include "tolerances.h"

namespace batten::internal::fit_primitive_test {

using ::testing::HasSubstr;

template <typename Shape>
double CostOf(const Shape& shape,
              const Eigen::Matrix3Xd& points,
              Loss loss = Loss::kNone,
              double scale = 1) {
  double sum = 0;
  for (const auto& p : points.colwise()) sum += LossValue(loss, DistanceTo(shape, p), scale);
  return sum;
}

CircleShape Nudged(CircleShape circle, RandomSplines& random, double by, bool plane) {
  const double size = by * circle.radius;
  circle.center += size * random.Vector(1);
  circle.normal = (circle.normal + by * random.Vector(1)).normalized();
  circle.radius += size * random.Real(-1, 1);
  if (plane) {
    circle.center.z() = 0;
    circle.normal = Eigen::Vector3d::UnitZ();
  }
  return circle;
}

LineShape Nudged(LineShape line, RandomSplines& random, double by, bool plane) {
  line.point += by * random.Vector(1);
  line.direction = (line.direction + by * random.Vector(1)).normalized();
  if (plane) {
    line.point.z() = line.direction.z() = 0;
    line.direction.normalize();
  }
  return line;
}

// Downhill from `shape` by random steps that grow while they succeed and shrink while they fail.
template <typename Shape>
double BruteForce(Shape shape, const Eigen::Matrix3Xd& points, RandomSplines& random, bool plane) {
  double best = CostOf(shape, points);
  for (double by = 0.3; by > 1e-7;) {
    bool better = false;
    for (int k = 0; k < 60; ++k) {
      const Shape next = Nudged(shape, random, by, plane);
      const double cost = CostOf(next, points);
      if (cost < best) {
        best = cost;
        shape = next;
        better = true;
      }
    }
    if (!better) by /= 2;
  }
  return best;
}

TEST(FitPrimitiveTest, CirclesThroughExactPointsAreExact) {
  RandomSplines random(1);
  for (int trial = 0; trial < 200; ++trial) {
    SCOPED_TRACE("seed 1, trial " + std::to_string(trial));
    const bool plane = random.Coin();
    const double sweep = random.Logarithmic(5, 360) * kDegree,
                 radius = random.Logarithmic(1e-3, 1e3);
    Place place = RandomPlace(random, plane, radius);
    place.scale = radius;
    const Eigen::Matrix3Xd points = place(ArcPoints(random.Integer(3, 60), sweep));
    const PrimitiveFit fit = FitPrimitive(Cloud(points, plane), Options(PrimitiveKind::kCircle));
    const CircleShape& circle = std::get<CircleShape>(fit.shape);
    // A point off by ε moves the centre of a short arc by ε/(1 − cos(sweep/2))-fold.
    const double lever = 1 / std::pow(std::sin(sweep / 8), 2);
    EXPECT_LT(std::abs(circle.radius - radius), kRounding * radius * lever);
    EXPECT_LT((circle.center - place.shift).norm(), kRounding * radius * lever);
    EXPECT_LT(fit.residuals.maxCoeff(), kRounding * radius);
    EXPECT_LT(OffShape(fit), kRounding * radius * lever);
    EXPECT_TRUE(fit.report.geometry.rational);
    EXPECT_EQ(fit.report.geometry.degree, std::vector<int>{2});
    EXPECT_EQ(*fit.report.geometry.primitive->radius, circle.radius);
    EXPECT_EQ(fit.report.geometry.primitive->center, circle.center);
    const PrimitiveFit chosen = FitPrimitive(Cloud(points, plane), Options(PrimitiveKind::kAuto));
    EXPECT_TRUE(std::holds_alternative<CircleShape>(chosen.shape));
  }
}

TEST(FitPrimitiveTest, LinesThroughExactPointsAreExact) {
  RandomSplines random(2);
  for (int trial = 0; trial < 200; ++trial) {
    SCOPED_TRACE("seed 2, trial " + std::to_string(trial));
    const bool plane = random.Coin();
    Place place = RandomPlace(random, plane, 10);
    place.scale = random.Logarithmic(1e-3, 1e3);
    const Eigen::Matrix3Xd points = place(LinePoints(random.Integer(2, 40), 1));
    const PrimitiveFit fit = FitPrimitive(
        Cloud(points, plane), Options(random.Coin() ? PrimitiveKind::kLine : PrimitiveKind::kAuto));
    ASSERT_TRUE(std::holds_alternative<LineShape>(fit.shape));
    const double size = place.scale + kRounding * 10;
    const Eigen::Vector3d& direction = std::get<LineShape>(fit.shape).direction;
    EXPECT_LT((direction - place.turn.col(0)).norm(), kRounding * 100 / place.scale + kRounding);
    EXPECT_LT(fit.residuals.maxCoeff(), kRounding * (size + 10));
    EXPECT_LT(OffShape(fit), kRounding * (size + 10));
    EXPECT_EQ(fit.report.geometry.degree, std::vector<int>{1});
    const auto ends = [&](const auto& curve) {
      const double length = (curve.control_points().col(1) - curve.control_points().col(0)).norm();
      EXPECT_NEAR(length, place.scale, kRounding * (size + 10));
    };
    std::visit(ends, fit.geometry);
  }
}

TEST(FitPrimitiveTest, TheSumOfSquaresIsTheLeast) {
  RandomSplines random(3);
  Noise noise(3);
  for (int trial = 0; trial < Cases(4); ++trial) {
    SCOPED_TRACE("seed 3, trial " + std::to_string(trial));
    const bool plane = random.Coin();
    const double sweep = random.Logarithmic(20, 360) * kDegree;
    Eigen::Matrix3Xd points = ArcPoints(random.Integer(6, 40), sweep);
    noise.AddTo(points, random.Logarithmic(1e-4, 0.1) * (1 - std::cos(sweep / 2)), plane);
    points = RandomPlace(random, plane, 2)(points);
    const PrimitiveFit fit = FitPrimitive(Cloud(points, plane), Options(PrimitiveKind::kCircle));
    const CircleShape& circle = std::get<CircleShape>(fit.shape);
    const double cost = CostOf(circle, points);
    EXPECT_GE(BruteForce(circle, points, random, plane), cost * (1 - kIterated));
    for (int start = 0; start < 3; ++start) {
      const CircleShape other = Nudged(circle, random, 0.5, plane);
      EXPECT_GE(BruteForce(other, points, random, plane), cost * (1 - kIterated));
    }
  }
  for (int trial = 0; trial < Cases(4); ++trial) {
    SCOPED_TRACE("seed 3, line " + std::to_string(trial));
    const bool plane = random.Coin();
    Eigen::Matrix3Xd points = LinePoints(random.Integer(4, 40), 1);
    noise.AddTo(points, random.Logarithmic(1e-4, 0.1), plane);
    points = RandomPlace(random, plane, 2)(points);
    const PrimitiveFit fit = FitPrimitive(Cloud(points, plane), Options(PrimitiveKind::kLine));
    const LineShape& line = std::get<LineShape>(fit.shape);
    const double cost = CostOf(line, points);
    EXPECT_GE(BruteForce(line, points, random, plane), cost * (1 - kIterated));
  }
}

Eigen::Matrix3Xd Used(const PrimitiveFit& fit, const Eigen::Matrix3Xd& points) {
  std::vector<Eigen::Index> used;
  for (Eigen::Index k = 0; k < points.cols(); ++k) {
    if (!fit.outliers[k]) used.push_back(k);
  }
  return points(Eigen::all, used);
}

// Short arcs under noise too, and with every loss at the scale that the report names.
TEST(FitPrimitiveTest, NothingNearbyCostsLess) {
  RandomSplines random(4);
  Noise noise(4);
  for (int trial = 0; trial < 40; ++trial) {
    SCOPED_TRACE("seed 4, trial " + std::to_string(trial));
    const bool plane = random.Coin();
    const double sweep = random.Logarithmic(5, 360) * kDegree;
    Eigen::Matrix3Xd points = ArcPoints(100, sweep);
    noise.AddTo(points, random.Logarithmic(1e-6, 0.3) * (1 - std::cos(sweep / 2)), plane);
    points = RandomPlace(random, plane, 2)(points);
    for (const Loss loss : {Loss::kNone, Loss::kHuber, Loss::kCauchy, Loss::kTukey}) {
      const PrimitiveFit fit =
          FitPrimitive(Cloud(points, plane), Options(PrimitiveKind::kCircle, loss));
      const CircleShape& circle = std::get<CircleShape>(fit.shape);
      const double scale = fit.report.geometry.primitive->scale;
      const Eigen::Matrix3Xd used = Used(fit, points);
      const double cost = CostOf(circle, used, loss, scale);
      for (const double by : {1e-7, 1e-5, 1e-3}) {
        for (int k = 0; k < 40; ++k) {
          const CircleShape other = Nudged(circle, random, by, plane);
          EXPECT_GE(CostOf(other, used, loss, scale), cost * (1 - kIterated));
        }
      }
      const PrimitiveFit straight =
          FitPrimitive(Cloud(points, plane), Options(PrimitiveKind::kLine, loss));
      const LineShape& line = std::get<LineShape>(straight.shape);
      const double s = straight.report.geometry.primitive->scale;
      const Eigen::Matrix3Xd near = Used(straight, points);
      const double least = CostOf(line, near, loss, s);
      for (const double by : {1e-7, 1e-5, 1e-3}) {
        for (int k = 0; k < 40; ++k) {
          const LineShape other = Nudged(line, random, by, plane);
          EXPECT_GE(CostOf(other, near, loss, s), least * (1 - kIterated));
        }
      }
    }
  }
}

// How far b is from a, relative to the size of a; infinite where the kind differs.
double Apart(const PrimitiveShape& a, const PrimitiveShape& b) {
  if (a.index() != b.index()) return HUGE_VAL;
  if (const auto* line = std::get_if<LineShape>(&a)) {
    const LineShape& other = std::get<LineShape>(b);
    return (line->point - other.point).norm() + (line->direction - other.direction).norm();
  }
  const CircleShape &circle = std::get<CircleShape>(a), &other = std::get<CircleShape>(b);
  return ((circle.center - other.center).norm() + std::abs(circle.radius - other.radius)) /
             circle.radius +
         (circle.normal - other.normal).norm();
}

// Rotated and shifted by whole numbers, scaled, and moved far away: the same shape there.
TEST(FitPrimitiveTest, TurnsAndMovesAndScalesWithThePoints) {
  RandomSplines random(5);
  Noise noise(5);
  for (int trial = 0; trial < 60; ++trial) {
    SCOPED_TRACE("seed 5, trial " + std::to_string(trial));
    const bool plane = random.Coin(), bent = random.Integer(0, 2) > 0;
    const double sweep = random.Real(60, 360) * kDegree;
    Eigen::Matrix3Xd points = bent ? ArcPoints(80, sweep) : LinePoints(80, 1);
    noise.AddTo(points, 0.01, plane);
    const Loss loss = random.Coin() ? Loss::kNone : Loss::kHuber;
    const PrimitiveFit here = FitPrimitive(Cloud(points, plane), Options({}, loss));
    EXPECT_EQ(std::holds_alternative<CircleShape>(here.shape), bent);
    for (const double distance : {1.0, 5e6}) {
      Place place = RandomPlace(random, plane, distance);
      place.scale = random.Logarithmic(1e-6, 1e6);
      place.shift *= place.scale;
      const PrimitiveFit there = FitPrimitive(Cloud(place(points), plane), Options({}, loss));
      auto moved = there.shape;
      const auto back = [&](const Eigen::Vector3d& p) {
        return Eigen::Vector3d(place.turn.transpose() * (p - place.shift) / place.scale);
      };
      if (auto* line = std::get_if<LineShape>(&moved)) {
        line->point = back(line->point);
        line->direction = place.turn.transpose() * line->direction;
      } else {
        auto& circle = std::get<CircleShape>(moved);
        circle.center = back(circle.center);
        circle.normal = place.turn.transpose() * circle.normal;
        circle.radius /= place.scale;
      }
      // Random choices see other points where the scaling rounds; sums and the far place round.
      const double rounding = distance > 1 ? 1e4 * kRounding * distance : kIterated * 100;
      EXPECT_LT(Apart(here.shape, moved), rounding);
      EXPECT_NEAR(there.report.error.rms / place.scale, here.report.error.rms, rounding);
      EXPECT_EQ(here.geometry.index(), there.geometry.index());
    }
  }
}

TEST(FitPrimitiveTest, WeightsCountAsRepeatedPoints) {
  RandomSplines random(6);
  Noise noise(6);
  for (const PrimitiveKind kind : {PrimitiveKind::kLine, PrimitiveKind::kCircle}) {
    for (int trial = 0; trial < 20; ++trial) {
      SCOPED_TRACE("seed 6, trial " + std::to_string(trial));
      Eigen::Matrix3Xd points = ArcPoints(30, random.Real(0.5, 6));
      noise.AddTo(points, 0.02, false);
      Eigen::VectorXd weights(30);
      std::vector<Eigen::Index> repeated;
      for (int k = 0; k < 30; ++k) {
        const int times = random.Integer(1, 4);
        weights[k] = times;
        repeated.insert(repeated.end(), times, k);
      }
      PointCloud weighted(points);
      weighted.set_weights(weights);
      const PrimitiveFit a = FitPrimitive(weighted, Options(kind));
      const PrimitiveFit b =
          FitPrimitive(PointCloud(points(Eigen::all, repeated).eval()), Options(kind));
      EXPECT_LT(Apart(a.shape, b.shape), kIterated);
      EXPECT_EQ(b.report.input.duplicates, static_cast<int>(repeated.size()) - 30);
      EXPECT_EQ(b.residuals.size(), static_cast<int>(repeated.size()));
    }
  }
}

// A short arc in space under noise: the joint problem, not a plane first. The plane through such
// points is decided by noise across the arc as much as by its bend.
TEST(FitPrimitiveTest, FindsShortNoisyArcsInSpace) {
  RandomSplines random(7);
  Noise noise(7);
  for (const double degrees : {5.0, 10.0, 30.0}) {
    const double sweep = degrees * kDegree, sagitta = 1 - std::cos(sweep / 2);
    double squares = 0;
    constexpr int kPoints = 400;
    const int trials = Cases(40);
    for (int trial = 0; trial < trials; ++trial) {
      SCOPED_TRACE("seed 7, trial " + std::to_string(trial));
      Eigen::Matrix3Xd points = ArcPoints(kPoints, sweep);
      noise.AddTo(points, 0.1 * sagitta, false);
      points = RandomPlace(random, false, 2)(points);
      const PrimitiveFit fit = FitPrimitive(Cloud(points, false), Options(PrimitiveKind::kAuto));
      ASSERT_TRUE(std::holds_alternative<CircleShape>(fit.shape));
      squares += std::pow(std::get<CircleShape>(fit.shape).radius - 1, 2);
    }
    // With y = −c κ/2 t² the curvature's variance is σ²·180·4/(N L⁴)·…: sd(κ) = σ √(720/N)/L².
    const double expected = 0.1 * sagitta * std::sqrt(720.0 / kPoints) / (sweep * sweep);
    EXPECT_LT(std::sqrt(squares / trials), 1.3 * expected);
    EXPECT_GT(std::sqrt(squares / trials), 0.7 * expected);
  }
}

TEST(FitPrimitiveTest, IsTheSameForEveryNumberOfThreads) {
  Noise noise(13);
  Eigen::Matrix3Xd points = ArcPoints(20000, 5);
  noise.AddTo(points, 0.01, false);
  PrimitiveFitOptions options = Options(PrimitiveKind::kAuto, Loss::kTukey);
  const PrimitiveFit two = FitPrimitive(Cloud(points, false), options);
  options.threads = 1;
  const PrimitiveFit one = FitPrimitive(Cloud(points, false), options);
  EXPECT_EQ(std::get<NurbsCurve<3>>(one.geometry), std::get<NurbsCurve<3>>(two.geometry));
  EXPECT_EQ(one.residuals, two.residuals);
}

TEST(FitPrimitiveTest, JudgesTheTolerance) {
  Noise noise(14);
  Eigen::Matrix3Xd points = ArcPoints(300, 5);
  noise.AddTo(points, 0.01, true);
  PrimitiveFitOptions options;
  options.tolerance = 0.1;
  EXPECT_EQ(FitPrimitive(Cloud(points, true), options).report.tolerance_reached(), true);
  options.tolerance = 0.01;
  const PrimitiveFit fit = FitPrimitive(Cloud(points, true), options);
  EXPECT_EQ(fit.report.tolerance_reached(), false);
  EXPECT_EQ(fit.report.end.code, EndCode::kNoiseReached);  // the tolerance is the noise
  EXPECT_THAT(fit.report.OneLine(), HasSubstr("circle of radius"));
}

TEST(FitPrimitiveTest, WritesCoordinatesLessTheShift) {
  const Eigen::Vector3d far(5e5, 5.4e6, 300);
  PrimitiveFitOptions options;
  options.shift = far;
  const PrimitiveFit fit =
      FitPrimitive(PointCloud::FromWorld(ArcPoints(40, 5).colwise() + far), options);
  EXPECT_LT(std::get<CircleShape>(fit.shape).center.norm(), 1e-8);
  EXPECT_LT(OffShape(fit), 1e-8);
}

}  // namespace batten::internal::fit_primitive_test
