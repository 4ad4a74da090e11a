// SPDX-License-Identifier: MIT
#include "batten/fitting/joint_stage.h"

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
#include "batten/fitting/joint_cells.h"
#include "batten/fitting/term_cost.h"
#include "joint_cases.h"
#include "known_clouds.h"
#include "tolerances.h"

namespace batten {
namespace {

using testing::HasSubstr;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

JointResult Solved(const JointCase& c, const JointOptions& options, int threads = 1) {
  ThreadPool pool(threads);
  return OptimizeJointly(c.problem, c.net, c.weights, options, pool);
}

JointKind Smooth(JointKind kind) {
  kind.least_degree = 2;
  return kind;
}

// Every kind of shape, with everything free that can be.
void ForCases(const std::function<void(RandomSplines&, JointCase&, JointOptions&)>& law,
              double noise = 0.03,
              int count = 150) {
  unsigned seed = 0;
  for (JointKind kind : JointKinds()) {
    for (int repeat = 0; repeat < 2; ++repeat) {
      kind = Smooth(kind);
      kind.noise = noise;
      kind.count = count;
      SCOPED_TRACE("seed " + std::to_string(++seed) + ", " + kind.Name());
      RandomSplines random(seed);
      JointCase c = RandomJointCase(random, kind);
      JointOptions options;
      options.free_weights = kind.rational;
      options.free_knots_u = repeat == 1 && !kind.periodic;
      options.free_knots_v = repeat == 1 && !kind.curve;
      options.stop_at_noise = false;
      law(random, c, options);
      if (testing::Test::HasFatalFailure()) return;
    }
  }
}

void Perturb(RandomSplines& random, JointCase& c, double distance) {
  for (double& x : c.net.reshaped()) x += random.Real(-distance, distance);
  const SplineBasis& u = c.problem.basis_u();
  if (!u.periodic()) return;
  const Eigen::Index copies = c.net.cols() / u.size() * u.degree();
  c.net.rightCols(copies) = c.net.leftCols(copies).eval();
}

bool Ordered(const SplineBasis& basis) {
  return std::is_sorted(basis.knots().begin(), basis.knots().end());
}

void ExpectWellFormed(const JointResult& result, const JointCase& c) {
  EXPECT_TRUE(result.control_points.allFinite());
  EXPECT_TRUE(result.weights.allFinite());
  EXPECT_GT(result.weights.minCoeff(), 0);
  EXPECT_TRUE(std::isfinite(result.rms_before) && std::isfinite(result.rms_after));
  EXPECT_TRUE(result.problem.data().parameters.allFinite());
  EXPECT_EQ(result.control_points.cols(), c.net.cols());
  EXPECT_EQ(result.problem.data().values, c.problem.data().values);
  const auto same_domain = [](const SplineBasis& now, const SplineBasis& before) {
    EXPECT_TRUE(Ordered(now));
    EXPECT_EQ(now.size(), before.size());
    EXPECT_EQ(now.lower(), before.lower());
    EXPECT_EQ(now.upper(), before.upper());
  };
  same_domain(result.problem.basis_u(), c.problem.basis_u());
  if (!c.problem.is_curve()) same_domain(result.problem.basis_v(), c.problem.basis_v());
}

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
TEST(JointStageTest, RecoversShapesFromExactPointsAndAWrongStart) {
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

TEST(JointStageTest, NeverReturnsWorseThanItsStart) {
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

TEST(JointStageTest, TellsTheRmsOfWhatItReturns) {
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
TEST(JointStageTest, NeverTurnsANormalInAStep) {
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
      Feet feet;
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

TEST(JointStageTest, GivesTheSameForEveryNumberOfThreads) {
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
TEST(JointStageTest, MovesAndScalesWithTheData) {
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

TEST(JointStageTest, StopsAtTheNoiseAndStaysThere) {
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
    if (first.note != kAtNoise) continue;
    ++stopped;
    // Neighbours are those of the parameters that the first began with.
    const auto as_given = [&](const SplineBasis& u) {
      return c.problem.is_curve() ? c.problem.WithBasis(u)
                                  : c.problem.WithBases(u, first.problem.basis_v());
    };
    const JointCase end{as_given(first.problem.basis_u()), first.control_points, first.weights};
    const JointResult again = Solved(end, options);
    EXPECT_EQ(again.note, kAtNoise);
    EXPECT_EQ(again.iterations, 0);
    EXPECT_EQ(again.control_points, first.control_points);
    EXPECT_EQ(again.weights, first.weights);
    EXPECT_EQ(again.problem.basis_u(), first.problem.basis_u());
    options.stop_at_noise = false;
    EXPECT_GT(Solved(end, options).iterations, 0);
  }
  EXPECT_GE(stopped, 3);
}

TEST(JointStageTest, CanBeCancelledAtAnyCall) {
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

TEST(JointStageTest, TakesNoStepWhereNoneIsAllowed) {
  ForCases([](RandomSplines& random, JointCase& c, JointOptions& options) {
    Perturb(random, c, 0.05);
    options.max_iterations = 0;
    const JointResult result = Solved(c, options);
    EXPECT_EQ(result.iterations, 0);
    EXPECT_EQ(result.control_points, c.net);
    EXPECT_EQ(result.rms_after, result.rms_before);
  });
}

TEST(JointStageTest, LeavesFixedControlPointsAndTheirWeightsAlone) {
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
TEST(JointStageTest, BearsCellsOfWhichEverythingIsFixed) {
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

TEST(JointStageTest, RefusesToFixWhatIsNotThere) {
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
TEST(JointStageTest, FollowsTheBulkWithALoss) {
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

// r = A x + ½ B x², of every value it is given.
class AnyTerm : public ResidualTerm {
 public:
  AnyTerm(std::vector<int> points, std::vector<int> weights, bool knots)
      : points_(std::move(points)), weights_(std::move(weights)), knots_(knots) {}
  int residuals() const override { return 3; }
  std::vector<int> ControlPoints() const override { return points_; }
  std::vector<int> Weights() const override { return weights_; }
  bool needs_knots() const override { return knots_; }
  bool Evaluate(std::span<const double> values,
                std::span<double> residual,
                std::span<double> jacobian) const override {
    for (size_t r = 0; r < 3; ++r) {
      residual[r] = 0;
      for (size_t k = 0; k < values.size(); ++k) {
        const double a = std::sin(1.0 + 3.7 * static_cast<double>(k) + static_cast<double>(r));
        const double b = std::cos(2.0 + 1.3 * static_cast<double>(k) - static_cast<double>(r));
        residual[r] += a * values[k] + b * values[k] * values[k] / 2;
        if (!jacobian.empty()) jacobian[r * values.size() + k] = a + b * values[k];
      }
    }
    return true;
  }

 private:
  std::vector<int> points_, weights_;
  bool knots_;
};

TEST(TermCostTest, HasTheDerivativesThatDifferencesFind) {
  ForCases([](RandomSplines&, JointCase& c, JointOptions& options) {
    const int n = static_cast<int>(c.net.cols());
    ThreadPool pool(1);
    JointCells cells(c.problem, c.net, c.weights, options, pool);
    ASSERT_TRUE(cells.Project());
    cells.Accept();
    // Over a periodic basis the first and one of the last control points are one.
    const TermCost cost(std::make_shared<AnyTerm>(
                            std::vector<int>{n - 1, 0, 1, 2}, std::vector<int>{3, 0, n - 1}, true),
                        cells);
    const std::vector<double*> blocks = cost.Blocks(cells);
    ASSERT_EQ(blocks.size(), cost.parameter_block_sizes().size());
    std::vector<RowMajor> jacobians;
    for (const int size : cost.parameter_block_sizes()) jacobians.emplace_back(3, size);
    std::vector<double*> out;
    for (RowMajor& J : jacobians) out.push_back(J.data());
    Eigen::Vector3d residual, above, below;
    ASSERT_TRUE(cost.Evaluate(nullptr, residual.data(), out.data()));
    Eigen::Vector3d plain;
    ASSERT_TRUE(cost.Evaluate(nullptr, plain.data(), nullptr));
    EXPECT_EQ(plain, residual);
    double seen = 0;
    for (size_t b = 0; b < blocks.size(); ++b) {
      for (Eigen::Index k = 0; k < jacobians[b].cols(); ++k) {
        constexpr double kStep = 1e-5;
        double& x = blocks[b][k];
        const double middle = x;
        x = middle + kStep;
        ASSERT_TRUE(cells.Project());
        ASSERT_TRUE(cost.Evaluate(nullptr, above.data(), nullptr));
        x = middle - kStep;
        ASSERT_TRUE(cells.Project());
        ASSERT_TRUE(cost.Evaluate(nullptr, below.data(), nullptr));
        x = middle;
        const Eigen::Vector3d expected = (above - below) / (2 * kStep);
        EXPECT_LE((jacobians[b].col(k) - expected).cwiseAbs().maxCoeff(), kHalfDigits)
            << "block " << b << ", unknown " << k;
        seen += expected.squaredNorm();
      }
    }
    EXPECT_GT(seen, 0.1);
    // Single blocks may be left out.
    out[0] = nullptr;
    const RowMajor last = jacobians.back();
    jacobians.back().setZero();
    ASSERT_TRUE(cells.Project());
    ASSERT_TRUE(cost.Evaluate(nullptr, residual.data(), out.data()));
    EXPECT_LE((jacobians.back() - last).cwiseAbs().maxCoeff(), kRounding * 100);
  });
}

TEST(TermCostTest, NamesWhatIsNotThere) {
  RandomSplines random(1);
  JointCase c = RandomJointCase(random, {});
  Perturb(random, c, 0.05);
  const int n = static_cast<int>(c.net.cols());
  JointOptions options;
  const auto refusal = [&](std::shared_ptr<const ResidualTerm> term) -> std::string {
    options.terms = {std::move(term)};
    try {
      Solved(c, options);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "accepted";
  };
  using List = std::vector<int>;
  EXPECT_EQ(refusal(std::make_shared<AnyTerm>(List{0, n - 1}, List{1}, true)), "accepted");
  EXPECT_THAT(refusal(std::make_shared<AnyTerm>(List{0, n}, List{}, true)),
              HasSubstr(std::to_string(n)));
  EXPECT_THAT(refusal(std::make_shared<AnyTerm>(List{-3}, List{}, true)), HasSubstr("-3"));
  EXPECT_THAT(refusal(std::make_shared<AnyTerm>(List{0}, List{n + 5}, true)),
              HasSubstr(std::to_string(n + 5)));
  EXPECT_THAT(refusal(nullptr), HasSubstr("term"));
}

// A linear form of the values wanted to be `target`.
class LinearTerm : public ResidualTerm {
 public:
  std::vector<int> points, weights;
  bool knots = false;
  Eigen::MatrixXd form;    // residuals × values, or as many columns as matter
  Eigen::VectorXd target;  // residuals
  bool works = true;

  int residuals() const override { return static_cast<int>(target.size()); }
  std::vector<int> ControlPoints() const override { return points; }
  std::vector<int> Weights() const override { return weights; }
  bool needs_knots() const override { return knots; }
  bool Evaluate(std::span<const double> values,
                std::span<double> residual,
                std::span<double> jacobian) const override {
    const auto count = static_cast<Eigen::Index>(values.size());
    Eigen::Map<Eigen::VectorXd> r(residual.data(), target.size());
    r = form * Eigen::Map<const Eigen::VectorXd>(values.data(), count).head(form.cols()) - target;
    if (!jacobian.empty()) {
      Eigen::Map<RowMajor> J(jacobian.data(), target.size(), count);
      J.setZero();
      J.leftCols(form.cols()) = form;
    }
    return works;
  }
};

constexpr double kHeavy = 1e4;  // beside some hundred points of weight 1, squared

TEST(ResidualTermTest, PullsAControlPointToItsPlace) {
  ForCases([](RandomSplines&, JointCase& c, JointOptions& options) {
    const Eigen::Index dim = c.net.rows();
    options.least_gain = 1e-8;
    options.max_iterations = 300;
    // Near enough that no step there turns the shape over.
    const Eigen::VectorXd place = c.net.col(1).array() + 0.02;
    auto term = std::make_shared<LinearTerm>();
    term->points = {1};
    term->form = kHeavy * Eigen::MatrixXd::Identity(dim, dim);
    term->target = kHeavy * place;
    options.terms = {term};
    const JointResult result = Solved(c, options);
    // The data's pull is some hundred points times some hundredths, against 1e8 times the miss; a
    // flat end of a long valley takes the rest.
    EXPECT_LE((result.control_points.col(1) - place).norm(), 1e-4);
    // Without terms it would be elsewhere.
    options.terms = {};
    EXPECT_GT((Solved(c, options).control_points.col(1) - place).norm(), 1e-3);
  });
}

TEST(ResidualTermTest, HoldsTheMeanOfTwoControlPoints) {
  ForCases([](RandomSplines&, JointCase& c, JointOptions& options) {
    const Eigen::Index dim = c.net.rows();
    const Eigen::VectorXd place =
        (c.net.col(0) + c.net.col(1)) / 2 + 0.03 * Eigen::VectorXd::Ones(dim);
    auto term = std::make_shared<LinearTerm>();
    term->points = {0, 1};
    term->form.resize(dim, 2 * dim);
    term->form << kHeavy / 2 * Eigen::MatrixXd::Identity(dim, dim),
        kHeavy / 2 * Eigen::MatrixXd::Identity(dim, dim);
    term->target = kHeavy * place;
    options.terms = {term};
    const JointResult result = Solved(c, options);
    EXPECT_LE(((result.control_points.col(0) + result.control_points.col(1)) / 2 - place).norm(),
              1e-6);
  });
}

TEST(ResidualTermTest, HoldsTheRatioOfTwoWeights) {
  ForCases([](RandomSplines&, JointCase& c, JointOptions& options) {
    options.free_weights = true;
    auto term = std::make_shared<LinearTerm>();
    term->weights = {0, 2};
    term->form.resize(1, 2);
    term->form << kHeavy, -1.5 * kHeavy;  // w_0 = 1.5 w_2
    term->target = Eigen::VectorXd::Zero(1);
    options.terms = {term};
    const JointResult result = Solved(c, options);
    EXPECT_NEAR(result.weights[0] / result.weights[2], 1.5, 1e-4);
  });
}

TEST(ResidualTermTest, PullsAKnotToItsPlace) {
  ForCases([](RandomSplines&, JointCase& c, JointOptions& options) {
    if (!options.free_knots_u) return;
    const SplineBasis& basis = c.problem.basis_u();
    const int index = basis.degree() + 1;
    const double place = basis.knots()[index] + 0.05;
    auto term = std::make_shared<LinearTerm>();
    term->knots = true;
    term->form = kHeavy * Eigen::RowVectorXd::Unit(index + 1, index);
    term->target = Eigen::VectorXd::Constant(1, kHeavy * place);
    options.terms = {term};
    const JointResult result = Solved(c, options);
    EXPECT_NEAR(result.problem.basis_u().knots()[index], place, 1e-4);
  });
}

// Without a place to evaluate it there is no step: the start comes back, and a word.
TEST(ResidualTermTest, ThatFailsAtTheStartLeavesTheStart) {
  ForCases([](RandomSplines& random, JointCase& c, JointOptions& options) {
    Perturb(random, c, 0.05);
    auto term = std::make_shared<LinearTerm>();
    term->points = {0};
    term->form = Eigen::MatrixXd::Identity(c.net.rows(), c.net.rows());
    term->target = c.net.col(0);
    term->works = false;
    options.terms = {term};
    const JointResult result = Solved(c, options);
    EXPECT_FALSE(result.note.empty());
    ExpectWellFormed(result, c);
    EXPECT_LE((result.control_points - c.net).cwiseAbs().maxCoeff(), kRounding);
  });
}

TEST(ResidualTermTest, MattersNotAtAllWhereEverythingItSeesIsFixed) {
  ForCases([](RandomSplines& random, JointCase& c, JointOptions& options) {
    Perturb(random, c, 0.05);
    options.free_weights = false;
    options.max_iterations = 6;
    options.least_gain = 0;
    options.fixed_control_points = {1};
    const JointResult without = Solved(c, options);
    auto term = std::make_shared<LinearTerm>();
    term->points = {1};
    term->form = Eigen::MatrixXd::Identity(c.net.rows(), c.net.rows());
    term->target = c.net.col(1).array() + 0.01;
    options.terms = {term};
    const JointResult with = Solved(c, options);
    EXPECT_LE((with.control_points - without.control_points).cwiseAbs().maxCoeff(), kHalfDigits);
  });
}

}  // namespace
}  // namespace batten
