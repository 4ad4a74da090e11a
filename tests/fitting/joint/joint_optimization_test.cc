// SPDX-License-Identifier: MIT
#include "fitting/joint/joint_optimization.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "batten/fitting/distances.h"
#include "fitting/joint/eliminated_problem.h"
#include "joint_runs.h"
#include "known_clouds.h"
#include "tolerances.h"

namespace batten::internal::joint_optimization_test {

using testing::HasSubstr;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// Root mean square of the distances at the parameters that the result says are foot points.
double DirectRms(const JointResult& result) {
  const FittingData& data = result.problem.data();
  const TensorShape shape = ShapeOf(result.problem, result.control_points, result.weights);
  double squares = 0;
  for (Eigen::Index k = 0; k < data.values.cols(); ++k) {
    const Eigen::Vector3d point = PointOf(shape, data.parameters(0, k), data.parameters(1, k));
    for (int d = 0; d < shape.dimension(); ++d)
      squares += std::pow(point[d] - data.values(d, k), 2);
  }
  return std::sqrt(squares / static_cast<double>(data.values.cols()));
}

// Every cell has more points than functions, so that fairness fades with the misfit.
TEST(JointOptimizationTest, RecoversShapesFromExactPointsAndAWrongStart) {
  ForCases(
      [](RandomSplines& random, JointCase& c, JointOptions& options) {
        options.free_knots_u = options.free_knots_v = options.free_weights = false;
        options.least_gain = 0;
        options.size = 1;
        Perturb(random, c, 0.02);
        const JointResult result = Solved(c, options);
        EXPECT_GT(result.rms_before, 1e-3);
        EXPECT_GT(result.iterations, 0);
        // What is left is a slide along the shape, by which distances hardly change.
        EXPECT_LE(result.rms_after, 1e-3 * result.rms_before);
        // At the right parameters the problem is linear, and fairness fades with the misfit. The
        // stop is at 1e-9 of a size of less than 10.
        options.orthogonal = false;
        EXPECT_LE(Solved(c, options).rms_after, 1e-8);
      },
      0,
      2000);
}

TEST(JointOptimizationTest, NeverReturnsWorseThanItsStart) {
  ForCases([](RandomSplines& random, JointCase& c, JointOptions& options) {
    Perturb(random, c, 0.05);
    options.max_iterations = 15;
    for (const bool orthogonal : {true, false}) {
      options.orthogonal = orthogonal;
      const JointResult result = Solved(c, options);
      ExpectWellFormed(result, c);
      EXPECT_LE(result.rms_after, result.rms_before);
      EXPECT_LT(result.rms_after, 0.99 * result.rms_before);  // there is much to gain
    }
  });
}

TEST(JointOptimizationTest, TellsTheRmsOfWhatItReturns) {
  ForCases([](RandomSplines& random, JointCase& c, JointOptions& options) {
    Perturb(random, c, 0.05);
    options.max_iterations = 6;
    for (const bool orthogonal : {true, false}) {
      options.orthogonal = orthogonal;
      const JointResult result = Solved(c, options);
      EXPECT_NEAR(DirectRms(result), result.rms_after, kIterated * result.rms_before);
      if (!orthogonal) {
        EXPECT_EQ(result.problem.data().parameters, c.problem.data().parameters);
      }
    }
  });
}

// Data of another shape altogether, with much noise and strangers: no step turns a normal over
// where there are data, nor folds the shape.
TEST(JointOptimizationTest, NeverTurnsANormalInAStep) {
  int steps = 0;
  for (unsigned seed = 0; seed < 6; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const SplineBasis bu = SplineBasis::Uniform(3, 6, 0, 1), bv = SplineBasis::Uniform(3, 5, 0, 1);
    Eigen::MatrixXd net(3, 30);
    for (int k = 0; k < 30; ++k) {
      net.col(k) << bu.Greville(k / 5) + random.Real(-0.02, 0.02),
          bv.Greville(k % 5) + random.Real(-0.02, 0.02), random.Real(-0.2, 0.2);
    }
    const Eigen::VectorXd weights = random.Weights(30, 0.6, 1.6);
    ThreadPool pool(1);
    auto data = std::make_shared<FittingData>();
    data->values = Scatter(Franke, 500, 0.2, 0.2, seed);
    data->parameters =
        DistancesTo(NurbsSurface(bu, bv, net, weights), data->values, pool).parameters;
    JointCase c{FittingProblem(bu, bv, data, 0), net, weights};
    JointOptions options;
    options.stop_at_noise = false;
    options.free_weights = seed % 2 == 1;
    // As many iterations as it takes to one accepted step, and on from there.
    for (options.max_iterations = 1; options.max_iterations <= 12; ++options.max_iterations) {
      const JointResult result = Solved(c, options);
      EXPECT_LE(result.rms_after, result.rms_before);
      if (result.rounds.size() != 2 || result.control_points == c.net) continue;
      const TensorShape was = ShapeOf(c.problem, c.net, c.weights);
      FootPointSet feet;
      FootProjector(data->values, true, pool).Project(was, c.problem.data().parameters, feet);
      Facing before = FacingOf(was, pool);
      before.Watch(was, feet.parameters);
      const TensorShape now = ShapeOf(result.problem, result.control_points, result.weights);
      EXPECT_TRUE(FacingOf(now, pool).Keeps(before)) << "step " << steps;
      ++steps;
      c = {result.problem, result.control_points, result.weights};
      options.max_iterations = 0;
      if (steps % 5 == 0) break;
    }
  }
  EXPECT_GE(steps, 10);
}

TEST(JointOptimizationTest, GivesTheSameForEveryNumberOfThreads) {
  ForCases([](RandomSplines& random, JointCase& c, JointOptions& options) {
    Perturb(random, c, 0.05);
    options.max_iterations = 8;
    const JointResult one = Solved(c, options), more = Solved(c, options, 2);
    EXPECT_LE((one.control_points - more.control_points).cwiseAbs().maxCoeff(), kIterated);
    EXPECT_LE((one.weights - more.weights).cwiseAbs().maxCoeff(),
              kIterated * one.weights.maxCoeff());
    EXPECT_EQ(one.iterations, more.iterations);
  });
}

// The whole in other units and at another place: the same steps, the same shape.
TEST(JointOptimizationTest, MovesAndScalesWithTheData) {
  ForCases([](RandomSplines& random, JointCase& c, JointOptions& options) {
    Perturb(random, c, 0.05);
    options.max_iterations = 8;
    options.least_gain = 0;
    const JointResult one = Solved(c, options);
    struct Frame {
      double unit, shift;
    };
    // Powers of two change no digit; other units and places change rounding, which eight steps with
    // weights and knots free amplify too much for a law.
    const bool plain = !options.free_weights && !options.free_knots_u && !options.free_knots_v;
    for (const Frame frame :
         {Frame{0x1p-30, 0}, Frame{0x1p30, 0}, Frame{1024, 0}, Frame{1e-9, 0}, Frame{1, 1e6}}) {
      const bool exact = frame.shift == 0 && frame.unit != 1e-9;
      if (!exact && !plain) continue;
      SCOPED_TRACE("unit " + std::to_string(std::log10(frame.unit)) + ", shift " +
                   std::to_string(frame.shift));
      auto data = std::make_shared<FittingData>(c.problem.data());
      data->values = (frame.unit * data->values).array() + frame.shift;
      JointCase other = c;
      other.problem = c.problem.is_curve()
                          ? FittingProblem(c.problem.basis_u(), data, 0)
                          : FittingProblem(c.problem.basis_u(), c.problem.basis_v(), data, 0);
      other.net = (frame.unit * c.net).array() + frame.shift;
      const JointResult result = Solved(other, options);
      // Rounding of coordinates far out, 1e6·2^-52 a point, is amplified by the condition of the
      // system, of 1e3 to 1e5, in each step.
      const double tolerance = exact ? 0 : frame.shift > 0 ? 1e-4 : kHalfDigits;
      EXPECT_NEAR(result.rms_after / frame.unit, one.rms_after, tolerance * one.rms_after);
      EXPECT_LE(
          ((result.control_points.array() - frame.shift) / frame.unit - one.control_points.array())
              .abs()
              .maxCoeff(),
          tolerance * 10);
    }
  });
}

TEST(JointOptimizationTest, StopsAtTheNoiseAndStaysThere) {
  int stopped = 0;
  for (unsigned seed = 0; seed < 10; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    JointCase c = RandomJointCase(
        random, {.curve = seed % 3 == 0, .noise = 1e-3, .count = 2000, .least_degree = 2});
    Perturb(random, c, 0.02);
    JointOptions options;
    const JointResult first = Solved(c, options);
    EXPECT_GT(first.iterations, 0);
    EXPECT_LE(first.rms_after, 2e-3);
    if (!first.at_noise) continue;
    ++stopped;
    // Neighbours are those of the parameters that the first began with.
    const auto as_given = [&](const SplineBasis& u) {
      return c.problem.is_curve() ? c.problem.WithBasis(u)
                                  : c.problem.WithBases(u, first.problem.basis_v());
    };
    const JointCase end{as_given(first.problem.basis_u()), first.control_points, first.weights};
    const JointResult again = Solved(end, options);
    EXPECT_TRUE(again.at_noise);
    EXPECT_EQ(again.iterations, 0);
    EXPECT_EQ(again.control_points, first.control_points);
    EXPECT_EQ(again.weights, first.weights);
    EXPECT_EQ(again.problem.basis_u(), first.problem.basis_u());
    options.stop_at_noise = false;
    EXPECT_GT(Solved(end, options).iterations, 0);
  }
  EXPECT_GE(stopped, 3);
}

TEST(JointOptimizationTest, CanBeCancelledAtAnyCall) {
  ForCases([](RandomSplines& random, JointCase& c, JointOptions& options) {
    Perturb(random, c, 0.05);
    options.max_iterations = 6;
    int calls = 0;
    options.progress = [&](const char*, double) { return ++calls > 0; };
    EXPECT_FALSE(Solved(c, options).cancelled);
    const int all = calls;
    ASSERT_GT(all, 0);
    for (int last = 1; last <= all; ++last) {
      SCOPED_TRACE("call " + std::to_string(last));
      calls = 0;
      options.progress = [&](const char*, double) { return ++calls < last; };
      const JointResult result = Solved(c, options);
      EXPECT_TRUE(result.cancelled);
      EXPECT_EQ(calls, last);
      ExpectWellFormed(result, c);
      EXPECT_LE(result.rms_after, result.rms_before);
      if (result.rms_after < result.rms_before) {
        EXPECT_NEAR(DirectRms(result), result.rms_after, kIterated * result.rms_before);
      }
    }
  });
}

TEST(JointOptimizationTest, TakesNoStepWhereNoneIsAllowed) {
  ForCases([](RandomSplines& random, JointCase& c, JointOptions& options) {
    Perturb(random, c, 0.05);
    options.max_iterations = 0;
    const JointResult result = Solved(c, options);
    EXPECT_EQ(result.iterations, 0);
    EXPECT_EQ(result.control_points, c.net);
    EXPECT_EQ(result.rms_after, result.rms_before);
  });
}

TEST(JointOptimizationTest, LeavesFixedControlPointsAndTheirWeightsAlone) {
  ForCases([](RandomSplines& random, JointCase& c, JointOptions& options) {
    Perturb(random, c, 0.05);
    options.max_iterations = 8;
    options.fixed_control_points = {0, 2, static_cast<int>(c.net.cols()) - 1};
    const JointResult result = Solved(c, options);
    EXPECT_LT(result.rms_after, result.rms_before);
    for (const int k : options.fixed_control_points) {
      EXPECT_EQ(result.control_points.col(k), c.net.col(k)) << k;
    }
    // Weights have a common factor, which is no property of the shape.
    const double ratio = result.weights[0] / c.weights[0];
    for (const int k : options.fixed_control_points) {
      EXPECT_NEAR(result.weights[k] / c.weights[k], ratio, kRounding * ratio) << k;
    }
    EXPECT_NE(result.control_points, c.net);
  });
}

// All control points of a cell, and all there are: what Ceres then sees has no Jacobian there.
TEST(JointOptimizationTest, BearsCellsOfWhichEverythingIsFixed) {
  ForCases([](RandomSplines& random, JointCase& c, JointOptions& options) {
    Perturb(random, c, 0.05);
    options.max_iterations = 5;
    options.free_knots_u = options.free_knots_v = false;
    const SplineBasis& u = c.problem.basis_u();
    const int size_v = c.problem.is_curve() ? 1 : c.problem.basis_v().size();
    for (const int rows : {u.degree() + 1, u.size()}) {
      options.fixed_control_points.clear();
      for (int k = 0; k < rows * size_v; ++k) options.fixed_control_points.push_back(k);
      const JointResult result = Solved(c, options);
      ExpectWellFormed(result, c);
      EXPECT_EQ(result.control_points.leftCols(rows * size_v), c.net.leftCols(rows * size_v));
      EXPECT_LE(result.rms_after, result.rms_before);
    }
  });
}

TEST(JointOptimizationTest, RefusesToFixWhatIsNotThere) {
  RandomSplines random(1);
  const JointCase c = RandomJointCase(random, {});
  JointOptions options;
  options.stop_at_noise = false;
  for (const int bad : {-1, static_cast<int>(c.net.cols())}) {
    options.fixed_control_points = {0, bad};
    try {
      Solved(c, options);
      ADD_FAILURE() << "accepted " << bad;
    } catch (const std::invalid_argument& error) {
      EXPECT_THAT(error.what(), HasSubstr(std::to_string(bad)));
    }
  }
}

// A tenth of the points lifted far off: every loss leaves the others nearer than squares do.
TEST(JointOptimizationTest, FollowsTheBulkWithALoss) {
  for (unsigned seed = 0; seed < 6; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    JointCase c = RandomJointCase(
        random, {.curve = seed % 2 == 1, .noise = 1e-3, .count = 2000, .least_degree = 2});
    auto data = std::make_shared<FittingData>(c.problem.data());
    std::vector<Eigen::Index> good;
    for (Eigen::Index k = 0; k < data->values.cols(); ++k) {
      if (k % 10 == 0) {
        data->values(2, k) += random.Real(0.1, 0.2);
      } else {
        good.push_back(k);
      }
    }
    const auto of_good = [&](Loss loss) {
      JointOptions options;
      options.loss = loss;
      options.loss_scale = 1e-3;
      options.stop_at_noise = false;
      const JointCase lifted{
          c.problem.is_curve() ? FittingProblem(c.problem.basis_u(), data, 0)
                               : FittingProblem(c.problem.basis_u(), c.problem.basis_v(), data, 0),
          c.net,
          c.weights};
      const JointResult result = Solved(lifted, options);
      const TensorShape shape = ShapeOf(result.problem, result.control_points, result.weights);
      double squares = 0;
      for (const Eigen::Index k : good) {
        squares += (PointOf(shape,
                            result.problem.data().parameters(0, k),
                            result.problem.data().parameters(1, k)) -
                    data->values.col(k))
                       .squaredNorm();
      }
      return std::sqrt(squares / static_cast<double>(good.size()));
    };
    const double squares = of_good(Loss::kNone);
    EXPECT_GT(squares, 5e-3);
    for (const Loss loss : {Loss::kHuber, Loss::kCauchy, Loss::kTukey}) {
      // Noise of 1e-3 in every coordinate; Huber's pull of a tenth of strangers is half a sigma.
      EXPECT_LE(of_good(loss), 2.5e-3) << static_cast<int>(loss);
    }
  }
}

}  // namespace batten::internal::joint_optimization_test
