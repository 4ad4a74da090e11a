// SPDX-License-Identifier: MIT
#include "fitting/curve/span_adaptation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "fitting/curve/parameter_correction.h"
#include "geometry/numeric/constants.h"
#include "tolerances.h"

namespace batten::internal::span_adaptation_test {

constexpr double kExact = 1e-8;  // curves that differ less are one; shapes here are of size one

using Place = std::function<Eigen::Vector3d(double)>;

Eigen::Vector3d Circle(double u) { return {std::cos(kTurn * u), std::sin(kTurn * u), 0}; }
Eigen::Vector3d Line(double u) { return {1 - 2 * u, 0.5 + u, 0.25 * u}; }
Eigen::Vector3d Parabola(double u) { return {2 * u - 1, (2 * u - 1) * (2 * u - 1), 0}; }
Eigen::Vector3d Wave(double u) { return {4 * u, std::sin(6 * u * u), 0}; }

struct Shape {
  const char* name;
  Place place;
  int dimension;
  bool closed;
};

const Shape kCircle{"circle", Circle, 2, true}, kLine{"line", Line, 3, false},
    kParabola{"parabola", Parabola, 2, false}, kWave{"wave", Wave, 2, false};

// Points in order along it, each coordinate thrown off by normal noise.
std::shared_ptr<FittingData> Sampled(const Shape& shape,
                                     int count,
                                     double noise,
                                     unsigned seed = 1) {
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal;
  auto data = std::make_shared<FittingData>();
  data->parameters = Eigen::Matrix2Xd::Zero(2, count);
  data->values.resize(shape.dimension, count);
  for (int k = 0; k < count; ++k) {
    const double u = shape.closed ? (k + 0.5) / count : static_cast<double>(k) / (count - 1);
    data->parameters(0, k) = u;
    const Eigen::Vector3d place = shape.place(u);
    for (int d = 0; d < shape.dimension; ++d)
      data->values(d, k) = place[d] + noise * normal(generator);
  }
  return data;
}

SpanAdaptation Adapted(const Shape& shape,
                       int degree,
                       std::shared_ptr<const FittingData> data,
                       const SpanAdaptOptions& options,
                       double length = 1) {
  ThreadPool pool(1);
  const SpanLayout start = SpanLayout::Equal(
      degree, std::max(8, shape.closed ? degree + 1 : 1), 0, length, {}, shape.closed);
  return AdaptSpans(FittingProblem(start.Basis(), std::move(data), 1e-10), start, options, pool);
}

SpanAdaptOptions Free() {
  SpanAdaptOptions options;
  options.exact = kExact;
  return options;
}

SpanAdaptOptions Within(double tolerance) {
  SpanAdaptOptions options = Free();
  options.tolerance = tolerance;
  return options;
}

int ControlPoints(const SpanAdaptation& adapted) { return adapted.layout.control_points(); }

// Of the data from the curve, across it, at their parameters.
double Farthest(const SpanAdaptation& adapted) {
  ThreadPool pool(1);
  const CurveSamples samples = CurveAt(adapted.problem, adapted.solution.coefficients, pool);
  return Across(adapted.problem.data().values - samples.points, samples.tangents)
      .colwise()
      .norm()
      .maxCoeff();
}

// The greatest distance of points of the curve from the shape, by many short chords of it.
double Deviation(const SpanAdaptation& adapted, const Shape& shape) {
  ThreadPool pool(1);
  const CurveSamples samples = CurveAt(adapted.problem, adapted.solution.coefficients, pool);
  double deviation = 0;
  for (Eigen::Index k = 0; k < samples.points.cols(); k += 31) {
    Eigen::Vector3d point = Eigen::Vector3d::Zero();
    for (int d = 0; d < shape.dimension; ++d) point[d] = samples.points(d, k);
    double nearest = std::numeric_limits<double>::infinity();
    for (int i = 0; i < 2000; ++i) {
      const Eigen::Vector3d from = shape.place(i / 2000.0),
                            side = shape.place((i + 1) / 2000.0) - from;
      const double along = std::clamp((point - from).dot(side) / side.squaredNorm(), 0.0, 1.0);
      nearest = std::min(nearest, (point - from - along * side).norm());
    }
    deviation = std::max(deviation, nearest);
  }
  return deviation;
}

TEST(AdaptSpansTest, ReturnsWhatBelongsTogether) {
  for (const Shape* shape : {&kCircle, &kLine, &kParabola, &kWave}) {
    for (const double noise : {0.0, 0.01}) {
      for (const std::optional<double> tolerance : {std::optional<double>(), std::optional(0.05)}) {
        SCOPED_TRACE(std::string(shape->name) + ", noise " + std::to_string(noise));
        SpanAdaptOptions options = Free();
        options.tolerance = tolerance;
        const SpanAdaptation adapted = Adapted(*shape, 3, Sampled(*shape, 500, noise), options);
        EXPECT_EQ(adapted.problem.basis_u(), adapted.layout.Basis());
        ThreadPool pool(1);
        EXPECT_EQ(adapted.solution.coefficients, SolveLinear(adapted.problem, pool).coefficients);
        EXPECT_FALSE(adapted.full);
        EXPECT_FALSE(adapted.rounds.empty());
      }
    }
  }
}

TEST(AdaptSpansTest, NeedsOneSpanForWhatOnePolynomialIs) {
  for (int degree = 2; degree <= 6; ++degree) {
    for (const int count : {30, 200, 2000}) {
      SCOPED_TRACE("degree " + std::to_string(degree) + ", " + std::to_string(count) + " points");
      EXPECT_EQ(ControlPoints(Adapted(kLine, degree, Sampled(kLine, count, 0), Free())),
                degree + 1);
      EXPECT_EQ(ControlPoints(Adapted(kParabola, degree, Sampled(kParabola, count, 0), Free())),
                degree + 1);
    }
  }
}

TEST(AdaptSpansTest, NeedsFewMoreForNoisyOnes) {
  for (unsigned seed = 1; seed <= 12; ++seed) {
    for (const Shape* shape : {&kLine, &kParabola}) {
      SCOPED_TRACE(std::string(shape->name) + ", seed " + std::to_string(seed));
      const SpanAdaptation adapted = Adapted(*shape, 3, Sampled(*shape, 1000, 0.01, seed), Free());
      EXPECT_LE(ControlPoints(adapted), 8);
      // Ends go along with the noise of few points.
      EXPECT_LE(Deviation(adapted, *shape), 0.01);
    }
  }
}

TEST(AdaptSpansTest, RecoversTheKnotsOfASplineWithoutNoise) {
  for (int degree = 2; degree <= 4; ++degree) {
    for (const bool closed : {false, true}) {
      SCOPED_TRACE("degree " + std::to_string(degree) + ", closed " + std::to_string(closed));
      // Sixteen equal spans, whose knots halving meets.
      const SpanLayout layout = SpanLayout::Equal(degree, 16, 0, 1, {}, closed);
      const SplineBasis basis = layout.Basis();
      Eigen::MatrixXd net(2, basis.size());
      for (int i = 0; i < basis.size(); ++i) {
        const double t = kTurn * (i % layout.control_points()) / layout.control_points();
        const double far = i % layout.control_points() % 2 == 0 ? 1 : 1.2;
        net.col(i) << far * std::cos(t), far * std::sin(t);
      }
      auto data = std::make_shared<FittingData>();
      data->parameters = Eigen::Matrix2Xd::Zero(2, 1000);
      for (Eigen::Index k = 0; k < 1000; ++k)
        data->parameters(0, k) = (static_cast<double>(k) + 0.5) / 1000;
      data->values = Eigen::MatrixXd::Zero(2, 1000);
      ThreadPool pool(1);
      data->values = EvaluateAt(FittingProblem(basis, data, 0), net, pool);
      SpanAdaptOptions options = Free();
      options.feet = false;
      const SpanLayout start = SpanLayout::Equal(degree, 8, 0, 1, {}, closed);
      const SpanAdaptation adapted =
          AdaptSpans(FittingProblem(start.Basis(), data, 0), start, options, pool);
      EXPECT_EQ(ControlPoints(adapted), layout.control_points());
      EXPECT_LE(adapted.solution.residual_squares, 1000 * kExact * kExact);
    }
  }
}

// Noise of σ in N points blurs a curve by σ/√N.
TEST(AdaptSpansTest, NeedsAsManyForFewGoodDataAsForManyBadOnes) {
  for (const Shape* shape : {&kCircle, &kWave}) {
    for (const int degree : {3, 4, 5}) {
      SCOPED_TRACE(std::string(shape->name) + ", degree " + std::to_string(degree));
      const double blur = 0.002 / std::sqrt(2000.0);
      const int few = ControlPoints(
          Adapted(*shape, degree, Sampled(*shape, 2000, blur * std::sqrt(2000.0)), Free()));
      const int many = ControlPoints(
          Adapted(*shape, degree, Sampled(*shape, 20000, blur * std::sqrt(20000.0)), Free()));
      EXPECT_LE(std::abs(few - many), std::max(2, few / 4)) << few << " and " << many;
    }
  }
}

TEST(AdaptSpansTest, TellsTheNoise) {
  for (const Shape* shape : {&kCircle, &kWave, &kLine, &kParabola}) {
    for (const double noise : {1e-4, 1e-3, 1e-2}) {
      SCOPED_TRACE(std::string(shape->name) + ", noise " + std::to_string(noise));
      const SpanAdaptation adapted = Adapted(*shape, 3, Sampled(*shape, 4000, noise), Free());
      EXPECT_NEAR(adapted.noise, noise, 0.1 * noise);
      EXPECT_LE(Deviation(adapted, *shape), noise);
    }
  }
}

TEST(AdaptSpansTest, KeepsATolerance) {
  for (const Shape* shape : {&kCircle, &kWave}) {
    for (const double tolerance : {1e-1, 1e-2, 1e-3, 1e-4}) {
      SCOPED_TRACE(std::string(shape->name) + ", tolerance " + std::to_string(tolerance));
      const SpanAdaptation adapted =
          Adapted(*shape, 3, Sampled(*shape, 2000, 0), Within(tolerance));
      EXPECT_LE(Farthest(adapted), tolerance);
    }
  }
}

TEST(AdaptSpansTest, NeedsFewerForACoarserTolerance) {
  for (const Shape* shape : {&kCircle, &kWave}) {
    int finer = 1000;
    for (const double tolerance : {1e-5, 1e-4, 1e-3, 1e-2, 1e-1}) {
      SCOPED_TRACE(std::string(shape->name) + ", tolerance " + std::to_string(tolerance));
      const int now =
          ControlPoints(Adapted(*shape, 3, Sampled(*shape, 2000, 0), Within(tolerance)));
      EXPECT_LE(now, finer);
      finer = now;
    }
  }
}

TEST(AdaptSpansTest, FollowsNoNoiseForATolerance) {
  for (const Shape* shape : {&kCircle, &kWave, &kLine}) {
    SCOPED_TRACE(shape->name);
    const auto data = Sampled(*shape, 3000, 0.01);
    const int free = ControlPoints(Adapted(*shape, 3, data, Free()));
    for (const double tolerance : {1e-2, 1e-3, 1e-5}) {
      // Nothing is removed where the tolerance is missed: up to some halvings more.
      EXPECT_LE(ControlPoints(Adapted(*shape, 3, data, Within(tolerance))), 2 * free + 8)
          << tolerance;
    }
  }
}

// Powers of two change no digit.
TEST(AdaptSpansTest, DoesNotKnowTheUnit) {
  for (const Shape* shape : {&kCircle, &kWave}) {
    for (const double noise : {0.0, 0.003}) {
      for (const std::optional<double> tolerance : {std::optional<double>(), std::optional(0.02)}) {
        for (const double unit : {std::ldexp(1, -20), std::ldexp(1, 20)}) {
          SCOPED_TRACE(std::string(shape->name) + ", unit " + std::to_string(unit));
          const auto data = Sampled(*shape, 1000, noise);
          auto scaled = std::make_shared<FittingData>(*data);
          scaled->values *= unit;
          SpanAdaptOptions here = Free();
          here.tolerance = tolerance;
          SpanAdaptOptions there = here;
          there.exact *= unit;
          if (tolerance) there.tolerance = *tolerance * unit;
          const SpanAdaptation one = Adapted(*shape, 3, data, here),
                               other = Adapted(*shape, 3, scaled, there);
          EXPECT_EQ(one.layout.breaks(), other.layout.breaks());
          EXPECT_NEAR(one.noise, other.noise / unit, kRounding);
        }
      }
    }
  }
}

TEST(AdaptSpansTest, DoesNotKnowTheUnitOfTheParameters) {
  for (const Shape* shape : {&kCircle, &kWave}) {
    for (const double length : {std::ldexp(1, -20), std::ldexp(1, 20)}) {
      SCOPED_TRACE(std::string(shape->name) + ", length " + std::to_string(length));
      const auto data = Sampled(*shape, 1000, 0.003);
      auto scaled = std::make_shared<FittingData>(*data);
      scaled->parameters *= length;
      const SpanAdaptation one = Adapted(*shape, 3, data, Free()),
                           other = Adapted(*shape, 3, scaled, Free(), length);
      ASSERT_EQ(one.layout.spans(), other.layout.spans());
      for (size_t k = 0; k < one.layout.breaks().size(); ++k)
        EXPECT_NEAR(one.layout.breaks()[k], other.layout.breaks()[k] / length, kRounding);
    }
  }
}

TEST(AdaptSpansTest, DoesNotKnowWhereTheOriginIs) {
  for (const Shape* shape : {&kCircle, &kWave}) {
    SCOPED_TRACE(shape->name);
    const auto data = Sampled(*shape, 1000, 0.003);
    auto shifted = std::make_shared<FittingData>(*data);
    shifted->values.array() += 1000;
    const SpanAdaptation here = Adapted(*shape, 3, data, Free()),
                         there = Adapted(*shape, 3, shifted, Free());
    EXPECT_EQ(here.layout.breaks(), there.layout.breaks());
    EXPECT_NEAR(here.noise, there.noise, kHalfDigits);
  }
}

TEST(AdaptSpansTest, DoesNotKnowWhichEndIsTheFirst) {
  for (const Shape* shape : {&kCircle, &kWave}) {
    for (const double noise : {0.0, 0.003}) {
      SCOPED_TRACE(std::string(shape->name) + ", noise " + std::to_string(noise));
      const auto data = Sampled(*shape, 1000, noise);
      auto reversed = std::make_shared<FittingData>(*data);
      reversed->values = data->values.rowwise().reverse();
      reversed->parameters.row(0) = 1 - data->parameters.row(0).reverse().array();
      const int one = ControlPoints(Adapted(*shape, 3, data, Free())),
                other = ControlPoints(Adapted(*shape, 3, reversed, Free()));
      // What is as cheap on both sides may go on one or the other.
      EXPECT_LE(std::abs(one - other), std::max(1, one / 10)) << one << " and " << other;
    }
  }
}

TEST(AdaptSpansTest, StopsAtTheMostControlPointsAndSaysSo) {
  for (const Shape* shape : {&kCircle, &kWave}) {
    SCOPED_TRACE(shape->name);
    SpanAdaptOptions options = Free();
    options.max_control_points = 20;
    const SpanAdaptation adapted = Adapted(*shape, 3, Sampled(*shape, 2000, 0), options);
    EXPECT_LE(ControlPoints(adapted), 20);
    EXPECT_TRUE(adapted.full);
  }
}

TEST(AdaptSpansTest, KeepsCorners) {
  const Shape tent{"tent",
                   [](double u) { return Eigen::Vector3d(2 * u - 1, 1 - std::abs(2 * u - 1), 0); },
                   2,
                   false};
  for (const double noise : {0.0, 0.003}) {
    ThreadPool pool(1);
    const SpanLayout start = SpanLayout::Equal(3, 8, 0, 1, {0.5}, false);
    const SpanAdaptation adapted = AdaptSpans(
        FittingProblem(start.Basis(), Sampled(tent, 1001, noise), 1e-10), start, Free(), pool);
    EXPECT_EQ(adapted.layout.corners(), std::vector<double>{0.5});
    // Seven, and what noise makes look as if it were worth its place.
    EXPECT_LE(ControlPoints(adapted), noise > 0 ? 12 : 7);
    EXPECT_LE(Farthest(adapted), noise > 0 ? 5 * noise : 1e-6);
  }
}

TEST(AdaptSpansTest, TakesVeryFewPoints) {
  for (int count = 2; count <= 12; ++count) {
    for (const Shape* shape : {&kCircle, &kLine, &kWave}) {
      if (shape->closed && count < 4) continue;
      SCOPED_TRACE(std::string(shape->name) + ", " + std::to_string(count) + " points");
      ThreadPool pool(1);
      const SpanLayout start = SpanLayout::Equal(3, shape->closed ? 4 : 1, 0, 1, {}, shape->closed);
      const SpanAdaptation adapted = AdaptSpans(
          FittingProblem(start.Basis(), Sampled(*shape, count, 0), 1e-10), start, Free(), pool);
      EXPECT_TRUE(adapted.solution.coefficients.allFinite());
      EXPECT_LE(ControlPoints(adapted), std::max(4, count));
    }
  }
}

TEST(AdaptSpansTest, GivesTheSameBitsForEveryNumberOfThreads) {
  const SpanLayout start = SpanLayout::Equal(3, 8, 0, 1, {}, false);
  const FittingProblem problem(start.Basis(), Sampled(kWave, 5000, 0.003), 1e-10);
  ThreadPool one(1), three(3);
  const SpanAdaptation a = AdaptSpans(problem, start, Free(), one),
                       b = AdaptSpans(problem, start, Free(), three);
  EXPECT_EQ(a.layout.breaks(), b.layout.breaks());
  EXPECT_EQ(a.solution.coefficients, b.solution.coefficients);
}

TEST(AdaptSpansTest, CanBeCancelled) {
  SpanAdaptOptions options = Free();
  options.progress = [](const char*, double) { return false; };
  EXPECT_THROW(Adapted(kWave, 3, Sampled(kWave, 500, 0), options), Cancelled);
}

double Score(const SpanAdaptation& adapted, const SpanAdaptation& noise_of) {
  ThreadPool pool(1);
  const CurveSamples samples = CurveAt(adapted.problem, adapted.solution.coefficients, pool);
  return Across(adapted.problem.data().values - samples.points, samples.tangents).squaredNorm() +
         2 * noise_of.noise * noise_of.noise * ControlPoints(adapted);
}

TEST(RelocatedSpansTest, ExplainsTheDataNotWorseForItsNumberOfKnots) {
  for (const Shape* shape : {&kCircle, &kWave}) {
    for (unsigned seed = 1; seed <= 4; ++seed) {
      SCOPED_TRACE(std::string(shape->name) + ", seed " + std::to_string(seed));
      const SpanAdaptation adapted = Adapted(*shape, 3, Sampled(*shape, 800, 0.01, seed), Free());
      ThreadPool pool(1);
      const SpanAdaptation relocated = RelocatedSpans(adapted, Free(), pool);
      EXPECT_LE(ControlPoints(relocated), ControlPoints(adapted));
      EXPECT_EQ(relocated.problem.basis_u(), relocated.layout.Basis());
      EXPECT_LE(Score(relocated, adapted), Score(adapted, adapted) * (1 + kIterated));
    }
  }
}

TEST(RelocatedWithinToleranceTest, KeepsTheToleranceWithFewer) {
  for (const Shape* shape : {&kCircle, &kWave}) {
    for (const double tolerance : {1e-2, 1e-3, 1e-4}) {
      SCOPED_TRACE(std::string(shape->name) + ", tolerance " + std::to_string(tolerance));
      const SpanAdaptation adapted =
          Adapted(*shape, 3, Sampled(*shape, 1000, 0), Within(tolerance));
      ThreadPool pool(1);
      const SpanAdaptation relocated = RelocatedWithinTolerance(adapted, Within(tolerance), pool);
      EXPECT_LE(ControlPoints(relocated), ControlPoints(adapted));
      EXPECT_LE(Farthest(relocated), tolerance);
    }
  }
}

}  // namespace batten::internal::span_adaptation_test
