// SPDX-License-Identifier: MIT
#include "batten/fitting/optimize.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <numbers>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "batten/fitting/distances.h"
#include "batten/fitting/solve_linear.h"
#include "fitting/joint/joint_result.h"
#include "jittered_shell.h"
#include "joint_cases.h"
#include "known_clouds.h"
#include "tolerances.h"

namespace batten::internal::optimize_test {

using std::numbers::pi;
using testing::HasSubstr;

constexpr FreeVariables kParameters{.parameters = true, .weights = false, .knots = false};

std::vector<FreeVariables> Freedoms() {
  std::vector<FreeVariables> all;
  for (int bits = 1; bits < 8; ++bits)
    all.push_back(
        {.parameters = (bits & 1) != 0, .weights = (bits & 2) != 0, .knots = (bits & 4) != 0});
  return all;
}

std::string Name(const FreeVariables& free) {
  return std::string(free.parameters ? "parameters " : "") + (free.weights ? "weights " : "") +
         (free.knots ? "knots" : "");
}

OptimizeOptions Free(FreeVariables free) {
  OptimizeOptions options;
  options.free = free;
  return options;
}

OptimizeResult Optimized(const JointCase& c, const OptimizeOptions& options, int threads = 1) {
  ThreadPool pool(threads);
  return Optimize(c.problem, c.net, c.weights, options, pool);
}

JointCase Linear(FittingProblem problem) {
  ThreadPool pool(1);
  Eigen::MatrixXd net = SolveLinear(problem, pool).coefficients;
  Eigen::VectorXd weights = Eigen::VectorXd::Ones(net.cols());
  return {std::move(problem), std::move(net), std::move(weights)};
}

void ExpectValid(const OptimizeResult& result, const JointCase& c) {
  EXPECT_TRUE(result.control_points.allFinite());
  ASSERT_EQ(result.control_points.cols(), result.problem.net_size());
  ASSERT_EQ(result.weights.size(), result.problem.net_size());
  EXPECT_TRUE(result.weights.allFinite());
  EXPECT_GT(result.weights.minCoeff(), 0);
  EXPECT_TRUE(std::isfinite(result.rms_before) && std::isfinite(result.rms_after));
  EXPECT_TRUE(result.problem.data().parameters.allFinite());
  EXPECT_EQ(result.problem.data().values, c.problem.data().values);
  const auto& knots = result.problem.basis_u().knots();
  EXPECT_TRUE(std::is_sorted(knots.begin(), knots.end()));
}

double Size(const Eigen::MatrixXd& points) {
  return (points.rowwise().maxCoeff() - points.rowwise().minCoeff()).norm();
}

// The points of an arc of 140 degrees, at parameters of equal angle.
JointCase ArcCase(int dimension, double sigma, Eigen::Index count, unsigned seed) {
  RandomSplines random(seed);
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> normal(0, 1);
  const Eigen::Matrix3d turn = random.Orthogonal();
  auto data = std::make_shared<FittingData>();
  data->parameters.setZero(2, count);
  data->values.resize(dimension, count);
  for (Eigen::Index k = 0; k < count; ++k) {
    const double t = static_cast<double>(k) / static_cast<double>(count - 1);
    const double angle = 140.0 / 180 * pi * t;
    Eigen::Vector3d point(std::cos(angle), std::sin(angle), 0);
    if (dimension == 3) point = turn * point;
    for (double& x : point) x += sigma * normal(engine);
    data->parameters(0, k) = t;
    data->values.col(k) = point.head(dimension);
  }
  return Linear(FittingProblem(SplineBasis::Uniform(2, 3, 0, 1), data, 0));
}

// A quarter of a cylinder, quadratic by linear.
JointCase CylinderCase(double sigma, Eigen::Index count, unsigned seed) {
  RandomSplines random(seed);
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> normal(0, 1);
  auto data = std::make_shared<FittingData>();
  data->parameters.resize(2, count);
  data->values.resize(3, count);
  for (Eigen::Index k = 0; k < count; ++k) {
    const double u = random.Real(0, 1), v = random.Real(0, 1);
    data->parameters.col(k) << u, v;
    data->values.col(k) << std::cos(pi / 2 * u), std::sin(pi / 2 * u), 2 * v;
    for (double& x : data->values.col(k)) x += sigma * normal(engine);
  }
  return Linear(
      FittingProblem(SplineBasis::Uniform(2, 3, 0, 1), SplineBasis::Uniform(1, 2, 0, 1), data, 0));
}

TEST(OptimizeTest, FindsACircleWithWeights) {
  for (const int dimension : {2, 3}) {
    for (unsigned seed = 0; seed < 3; ++seed) {
      SCOPED_TRACE("dimension " + std::to_string(dimension) + ", seed " + std::to_string(seed));
      const JointCase c = ArcCase(dimension, 0, 80, seed);
      const OptimizeResult result =
          Optimized(c, Free({.parameters = true, .weights = true, .knots = false}));
      ExpectValid(result, c);
      EXPECT_TRUE(result.ran);
      EXPECT_GT(result.rms_before, 1e-3);
      EXPECT_LE(result.rms_after, 1e-8 * Size(c.net));
    }
  }
}

TEST(OptimizeTest, FindsACylinderWithWeights) {
  for (unsigned seed = 0; seed < 3; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const JointCase c = CylinderCase(0, 400, seed);
    const OptimizeResult result =
        Optimized(c, Free({.parameters = true, .weights = true, .knots = false}));
    ExpectValid(result, c);
    EXPECT_GT(result.rms_before, 1e-3);
    EXPECT_LE(result.rms_after, 1e-8 * Size(c.net));
  }
}

TEST(OptimizeTest, KeepsWeightsNearOneOnNoisyConics) {
  for (unsigned seed = 0; seed < 6; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    for (const bool cylinder : {false, true}) {
      const JointCase c = cylinder ? CylinderCase(0.01, 800, seed) : ArcCase(2, 0.01, 400, seed);
      // Distances of noise-free points.
      const auto truth = [&](const OptimizeResult& result) {
        ThreadPool pool(1);
        Eigen::Matrix3Xd exact = Eigen::Matrix3Xd::Zero(3, 400);
        for (int k = 0; k < 400; ++k) {
          const double angle = (cylinder ? 90 : 140) / 180.0 * pi * (k % 20 + 0.5) / 20;
          exact.col(k).head<2>() << std::cos(angle), std::sin(angle);
          if (cylinder) exact(2, k) = 2 * (k / 20 + 0.5) / 20;
        }
        const Eigen::VectorXd distances =
            cylinder
                ? DistancesTo(NurbsSurface(result.problem.basis_u(),
                                           result.problem.basis_v(),
                                           result.control_points,
                                           result.weights),
                              exact,
                              pool)
                      .distances
                : DistancesTo(NurbsCurve<2>(
                                  result.problem.basis_u(), result.control_points, result.weights),
                              exact,
                              pool)
                      .distances;
        return std::sqrt(distances.squaredNorm() / 400);
      };
      const OptimizeResult with =
          Optimized(c, Free({.parameters = true, .weights = true, .knots = false}));
      const OptimizeResult without = Optimized(c, Free(kParameters));
      ExpectValid(with, c);
      EXPECT_GE(with.weights.minCoeff(), 0.1);
      EXPECT_LE(with.weights.maxCoeff(), 10);
      EXPECT_LE(truth(with), truth(without)) << (cylinder ? "cylinder" : "arc");
      // What lies beyond the data is the shape's too: it must not run away, or no further than
      // without weights.
      EXPECT_LE(Size(with.control_points), std::max(2 * Size(c.net), Size(without.control_points)))
          << (cylinder ? "cylinder" : "arc");
    }
  }
}

// A sheet of type S with a net that already fits: what optimisation then follows is noise.
TEST(LongOptimizeTest, DoesNotFollowTheNoiseOfASheetThatFits) {
  for (unsigned seed = 0; seed < 4; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    auto data = std::make_shared<FittingData>();
    data->values = internal::Scatter(Franke, 3000, 1e-3, 0, seed);
    data->parameters = data->values.topRows(2);
    const SplineBasis basis = SplineBasis::Uniform(3, 18, 0, 1);
    const JointCase c = Linear(FittingProblem(basis, basis, data, 1e-6));
    ThreadPool pool(2);
    // Points of the square but for its rim: where the shape ends beside the data is not noise.
    const auto truth = [&](const NurbsSurface& surface) {
      Eigen::Matrix3Xd grid = TruthGrid(Franke, 40);
      for (auto point : grid.colwise()) {
        point.head<2>() = (0.03 + 0.94 * point.head<2>().array()).matrix().eval();
        point[2] = Franke(point[0], point[1]);
      }
      return std::sqrt(DistancesTo(surface, grid, pool).distances.squaredNorm() /
                       static_cast<double>(grid.cols()));
    };
    const double before = truth(NurbsSurface(basis, basis, c.net));
    for (const FreeVariables free :
         {kParameters, FreeVariables{.parameters = true, .weights = true, .knots = false}}) {
      const OptimizeResult result = Optimized(c, Free(free), 2);
      ExpectValid(result, c);
      EXPECT_LE(truth(NurbsSurface(result.problem.basis_u(),
                                   result.problem.basis_v(),
                                   result.control_points,
                                   result.weights)),
                1.1 * before)
          << Name(free);
    }
  }
}

TEST(LongOptimizeTest, RepairsJitteredParameters) {
  for (unsigned seed = 0; seed < 2; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const ShellKind kind{.seed = seed};
    const JointCase c = Linear(JitteredShell(kind));
    ThreadPool pool(2);
    const OptimizeResult result = Optimized(c, Free(kParameters), 2);
    ExpectValid(result, c);
    const NurbsSurface surface(
        result.problem.basis_u(), result.problem.basis_v(), result.control_points);
    const double squares =
        DistancesTo(surface, c.problem.data().values, pool).distances.squaredNorm();
    const double noise =
        kind.sigma * kind.sigma * static_cast<double>(kind.points - kind.net * kind.net);
    EXPECT_LE(squares, 1.03 * noise);
    // The least that noise leaves is σ √(n/m) = 2.1e-4.
    EXPECT_LE(ShellTruthRms(surface, pool), 4e-4);
  }
}

TEST(OptimizeTest, RunsWithEveryFreedom) {
  unsigned seed = 0;
  for (const JointKind& any : JointKinds()) {
    for (const FreeVariables& free : Freedoms()) {
      if (any.periodic && free.knots) continue;
      JointKind kind = any;
      kind.count = 120;
      kind.most_degree = 3;
      SCOPED_TRACE("seed " + std::to_string(++seed) + ", " + kind.Name() + ", " + Name(free));
      RandomSplines random(seed);
      const JointCase c = RandomJointCase(random, kind);
      OptimizeOptions options = Free(free);
      options.max_iterations = 5;
      options.stop_at_noise = false;
      const OptimizeResult result = Optimized(c, options);
      ExpectValid(result, c);
      EXPECT_TRUE(result.ran);
      EXPECT_LE(result.rms_after, result.rms_before * (1 + kIterated));
      if (!free.parameters) {
        EXPECT_EQ(result.problem.data().parameters, c.problem.data().parameters);
      }
      if (!free.weights) {
        EXPECT_LE(
            (result.weights / result.weights[0] - c.weights / c.weights[0]).cwiseAbs().maxCoeff(),
            kRounding);
      }
      // Weights shift the ends of the domain with the foot points; else it stays.
      if (!free.knots && !free.weights) {
        EXPECT_EQ(result.problem.basis_u(), c.problem.basis_u());
      }
      EXPECT_EQ(result.problem.basis_u().degree(), c.problem.basis_u().degree());
      if (!free.weights) {
        EXPECT_EQ(result.problem.basis_u().lower(), c.problem.basis_u().lower());
        EXPECT_EQ(result.problem.basis_u().upper(), c.problem.basis_u().upper());
      }
    }
  }
}

TEST(OptimizeTest, MovesKnotsOnlyInTheDirectionsThatAreFree) {
  RandomSplines random(3);
  const JointCase c = RandomJointCase(random, {.count = 600, .least_degree = 2});
  OptimizeOptions options = Free({.parameters = true, .weights = false, .knots = true});
  options.stop_at_noise = false;
  options.knots_u = false;
  EXPECT_EQ(Optimized(c, options).problem.basis_u(), c.problem.basis_u());
  options.knots_u = true;
  options.knots_v = false;
  EXPECT_EQ(Optimized(c, options).problem.basis_v(), c.problem.basis_v());
}

TEST(OptimizeTest, GivesTheSameForEveryNumberOfThreads) {
  unsigned seed = 40;
  for (const FreeVariables& free : Freedoms()) {
    SCOPED_TRACE("seed " + std::to_string(++seed) + ", " + Name(free));
    RandomSplines random(seed);
    const JointCase c =
        RandomJointCase(random, {.curve = seed % 2 == 0, .count = 600, .least_degree = 2});
    OptimizeOptions options = Free(free);
    options.max_iterations = 8;
    options.stop_at_noise = false;
    const OptimizeResult one = Optimized(c, options), two = Optimized(c, options, 2);
    EXPECT_NEAR(one.rms_after, two.rms_after, kIterated * one.rms_after);
    ASSERT_EQ(one.control_points.cols(), two.control_points.cols());
    EXPECT_LE((one.control_points - two.control_points).cwiseAbs().maxCoeff(),
              kIterated * Size(c.net));
  }
}

TEST(OptimizeTest, DoesNothingWhereTheResidualsAreNoise) {
  int quiet = 0;
  for (unsigned seed = 0; seed < 10; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const JointCase c =
        Linear(JitteredShell({.points = 3000, .net = 12, .jitter = 0, .seed = seed}));
    const OptimizeResult result = Optimized(c, Free(kParameters));
    if (result.ran) continue;
    ++quiet;
    EXPECT_EQ(result.note, "the residuals are at the noise");
    EXPECT_EQ(result.iterations, 0);
    EXPECT_EQ(result.control_points, c.net);
    EXPECT_EQ(result.rms_after, result.rms_before);
  }
  EXPECT_GE(quiet, 1);
}

TEST(OptimizeTest, DoesNothingWhereNothingIsFree) {
  RandomSplines random(1);
  const JointCase c = RandomJointCase(random, {});
  const OptimizeResult result = Optimized(c, Free({}));
  EXPECT_FALSE(result.ran);
  EXPECT_EQ(result.iterations, 0);
  EXPECT_EQ(result.control_points, c.net);
}

TEST(OptimizeTest, CanBeCancelledAtAnyCall) {
  unsigned seed = 60;
  for (const FreeVariables& free : Freedoms()) {
    SCOPED_TRACE("seed " + std::to_string(++seed) + ", " + Name(free));
    RandomSplines random(seed);
    const JointCase c = RandomJointCase(
        random, {.curve = seed % 2 == 0, .count = 120, .least_degree = 2, .most_degree = 3});
    OptimizeOptions options = Free(free);
    options.max_iterations = 4;
    options.stop_at_noise = false;
    int calls = 0;
    options.progress = [&](const char*, double fraction) {
      EXPECT_GE(fraction, 0);
      EXPECT_LE(fraction, 1);
      return ++calls > 0;
    };
    EXPECT_FALSE(Optimized(c, options).cancelled);
    const int all = calls;
    EXPECT_GT(all, 0);
    for (int last = 1; last <= all; last += std::max(1, all / 3)) {
      SCOPED_TRACE("call " + std::to_string(last) + " of " + std::to_string(all));
      calls = 0;
      options.progress = [&](const char*, double) { return ++calls < last; };
      const OptimizeResult result = Optimized(c, options);
      EXPECT_TRUE(result.cancelled);
      EXPECT_LE(calls, last + 1);
      ExpectValid(result, c);
      EXPECT_LE(result.rms_after, result.rms_before * (1 + kIterated));
    }
  }
}

// Data that do not determine a shape, in several units.
void BearBadData(const std::vector<double>& units, const std::vector<FreeVariables>& freedoms) {
  struct Bad {
    const char* name;
    std::function<void(RandomSplines&, FittingData&)> spoil;
  };
  const Bad kinds[] = {
      {"fewer points than unknowns",
       [](RandomSplines&, FittingData& d) {
         d.parameters.conservativeResize(2, 7);
         d.values.conservativeResize(3, 7);
       }},
      {"one point",
       [](RandomSplines&, FittingData& d) {
         d.parameters.conservativeResize(2, 1);
         d.values.conservativeResize(3, 1);
       }},
      {"all in one cell",
       [](RandomSplines&, FittingData& d) {
         d.parameters = (0.1 * d.parameters).eval();
         d.values.topRows(2) = d.parameters;
       }},
      {"all on a line",
       [](RandomSplines&, FittingData& d) {
         d.values.row(1) = 2 * d.values.row(0);
         d.values.row(2) = -d.values.row(0);
       }},
      {"all on a line, also their parameters",
       [](RandomSplines&, FittingData& d) {
         d.parameters.row(1) = d.parameters.row(0);
         d.values.row(1) = d.values.row(0);
         d.values.row(2).setZero();
       }},
      {"all the same",
       [](RandomSplines&, FittingData& d) {
         d.values.colwise() = Eigen::Vector3d(1, 2, 3);
         d.parameters.setConstant(0.5);
       }},
      {"the same place at all parameters",
       [](RandomSplines&, FittingData& d) { d.values.colwise() = Eigen::Vector3d(1, 2, 3); }},
      {"each point twice",
       [](RandomSplines&, FittingData& d) {
         d.values.rightCols(100) = d.values.leftCols(100).eval();
         d.parameters.rightCols(100) = d.parameters.leftCols(100).eval();
       }},
      {"hardly any weight",
       [](RandomSplines&, FittingData& d) {
         d.weights.setZero(d.values.cols());
         d.weights.head(3).setOnes();
       }},
      {"no weight at all",
       [](RandomSplines&, FittingData& d) { d.weights.setZero(d.values.cols()); }},
      {"parameters at random",
       [](RandomSplines& random, FittingData& d) {
         for (double& u : d.parameters.reshaped()) u = random.Real(0, 1);
       }},
      {"parameters all at the corners",
       [](RandomSplines& random, FittingData& d) {
         for (double& u : d.parameters.reshaped()) u = random.Coin() ? 1 : 0;
       }},
  };
  unsigned seed = 0;
  for (const Bad& bad : kinds) {
    for (const FreeVariables& free : freedoms) {
      for (const double unit : units) {
        SCOPED_TRACE(std::string(bad.name) + ", " + Name(free) + ", unit " + std::to_string(unit));
        RandomSplines random(++seed);
        auto data = std::make_shared<FittingData>();
        data->values = internal::Scatter(Franke, 200, 1e-3, 0, seed);
        data->parameters = data->values.topRows(2);
        bad.spoil(random, *data);
        data->values *= unit;
        const SplineBasis basis = SplineBasis::Uniform(3, 5, 0, 1);
        // A start that needs no solution: the plane over the parameters.
        Eigen::MatrixXd net(3, 25);
        for (int k = 0; k < 25; ++k)
          net.col(k) << unit * basis.Greville(k / 5), unit * basis.Greville(k % 5), 0;
        const JointCase c{FittingProblem(basis, basis, data, 1e-6), net, Eigen::VectorXd::Ones(25)};
        OptimizeOptions options = Free(free);
        options.max_iterations = 3;
        try {
          const OptimizeResult result = Optimized(c, options);
          ExpectValid(result, c);
          EXPECT_LE(result.rms_after, result.rms_before * (1 + kIterated));
        } catch (const std::exception& error) {
          ADD_FAILURE() << error.what();
        }
      }
    }
  }
}

TEST(OptimizeTest, BearsBadData) { BearBadData({1}, {kParameters, Freedoms().back()}); }
TEST(LongOptimizeTest, BearsBadDataOfAnySize) {
  BearBadData({1, 1e-9, 1e-3, 1e3, 1e9}, Freedoms());
}

// Optimal shapes move and scale with the data. Powers of two and no shift change no digit.
TEST(OptimizeTest, ScalesWithTheData) {
  for (const FreeVariables& free : Freedoms()) {
    SCOPED_TRACE(Name(free));
    RandomSplines random(5);
    const JointCase c = RandomJointCase(random, {.curve = true, .count = 400, .least_degree = 2});
    OptimizeOptions options = Free(free);
    options.stop_at_noise = false;
    const OptimizeResult one = Optimized(c, options);
    for (const double unit : {0x1p-30, 0x1p30}) {
      for (const double shift : {0.0, 1e6}) {
        auto data = std::make_shared<FittingData>(c.problem.data());
        data->values = (unit * data->values).array() + unit * shift;
        const JointCase other{FittingProblem(c.problem.basis_u(), data, 0),
                              (unit * c.net).array() + unit * shift,
                              c.weights};
        const OptimizeResult result = Optimized(other, options);
        // A minimum carries half of the digits; far out, points have ten digits, and what is
        // minimised is known to the square of the remainder.
        EXPECT_NEAR(result.rms_after / unit, one.rms_after, 1e-4 * one.rms_after)
            << "unit " << unit << ", shift " << shift;
      }
    }
  }
}

TEST(OptimizeTest, RefusesSizesThatDoNotAgree) {
  RandomSplines random(1);
  const JointCase c = RandomJointCase(random, {});
  const Eigen::Index n = c.net.cols();
  const OptimizeOptions options = Free(kParameters);
  EXPECT_THROW(Optimized({c.problem, c.net.leftCols(n - 1), c.weights}, options),
               std::invalid_argument);
  EXPECT_THROW(Optimized({c.problem, c.net, c.weights.head(n - 1)}, options),
               std::invalid_argument);
  EXPECT_THROW(Optimized({c.problem, c.net.topRows(2), c.weights}, options), std::invalid_argument);
  EXPECT_THROW(Optimized({c.problem, c.net, -c.weights}, options), std::invalid_argument);
  OptimizeOptions fixed = options;
  fixed.stop_at_noise = false;
  fixed.fixed_control_points = {static_cast<int>(n)};
  EXPECT_THROW(Optimized(c, fixed), std::invalid_argument);
}

TEST(OptimizeTest, NamesTheOptionThatBreaksItsRule) {
  const auto refusal = [](const std::function<void(OptimizeOptions&)>& spoil) -> std::string {
    OptimizeOptions options;
    spoil(options);
    try {
      Check(options);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_EQ(refusal([](OptimizeOptions&) {}), "accepted");
  EXPECT_THAT(refusal([](OptimizeOptions& o) { o.max_iterations = 0; }),
              HasSubstr("max_iterations"));
  for (const double bad : {-1.0, std::nan("")}) {
    EXPECT_THAT(refusal([&](OptimizeOptions& o) { o.noise = bad; }), HasSubstr("noise"));
    EXPECT_THAT(refusal([&](OptimizeOptions& o) { o.least_gain = bad; }), HasSubstr("least_gain"));
    EXPECT_THAT(refusal([&](OptimizeOptions& o) { o.loss_scale = bad; }), HasSubstr("loss_scale"));
    EXPECT_THAT(refusal([&](OptimizeOptions& o) { o.fairness = bad; }), HasSubstr("fairness"));
    EXPECT_THAT(refusal([&](OptimizeOptions& o) { o.seconds = bad; }), HasSubstr("seconds"));
  }
  const double infinite = std::numeric_limits<double>::infinity();
  EXPECT_THAT(refusal([&](OptimizeOptions& o) { o.noise = infinite; }), HasSubstr("noise"));
  EXPECT_THAT(refusal([&](OptimizeOptions& o) { o.fairness = infinite; }), HasSubstr("fairness"));
  EXPECT_THAT(refusal([](OptimizeOptions& o) { o.loss_scale = 0; }), HasSubstr("loss_scale"));
}

}  // namespace batten::internal::optimize_test
