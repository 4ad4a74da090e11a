// SPDX-License-Identifier: MIT
// The three models of distance: none ever makes the fit worse, all end where nothing nearby is
// better, and the two that let feet slide get there sooner.
#include "fitting/curve/distance_minimisation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <random>
#include <stdexcept>
#include <string>

#include "batten/fitting/solve_linear.h"
#include "batten/geometry/foot_point.h"
#include "batten/geometry/knot_vectors.h"
#include "random_splines.h"
#include "tolerances.h"

namespace batten::internal::distance_minimisation_test {

using ::testing::HasSubstr;

constexpr DistanceModel kModels[] = {
    DistanceModel::kPoint, DistanceModel::kTangent, DistanceModel::kSquared};

DistanceMinimum Minimise(const FittingProblem& problem,
                         const Eigen::MatrixXd& net,
                         const DistanceMinimisationOptions& options) {
  ThreadPool pool(2);
  return MinimiseDistance(problem, net, options, pool);
}

DistanceMinimisationOptions Options(DistanceModel model, int rounds = 50, double gain = 1e-6) {
  DistanceMinimisationOptions options;
  options.model = model;
  options.max_rounds = rounds;
  options.relative_gain = gain;
  return options;
}

struct Case {
  FittingProblem problem;
  Eigen::MatrixXd net;
};

Eigen::Vector2d Flower(double t) {
  return (1 + 0.3 * std::cos(5 * t)) * Eigen::Vector2d(std::cos(t), std::sin(t));
}

// Points of a flower whose parameters are off by much, and a net near the curve.
Case FlowerCase(bool closed, int count, int spans, double sigma, unsigned seed) {
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> noise(0, 1);
  std::uniform_real_distribution<double> uniform(0, 1);
  const double turn = closed ? 2 * std::numbers::pi : 5.5;
  auto data = std::make_shared<FittingData>();
  data->values.resize(2, count);
  data->parameters = Eigen::Matrix2Xd::Zero(2, count);
  for (int k = 0; k < count; ++k) {
    const double s = uniform(engine);
    data->values.col(k) = Flower(turn * s) + sigma * Eigen::Vector2d(noise(engine), noise(engine));
    const double bad = s + 0.02 * std::sin(18 * std::numbers::pi * s) + 0.005 * noise(engine);
    data->parameters(0, k) = closed ? bad - std::floor(bad) : std::clamp(bad, 0.0, 1.0);
  }
  const SplineBasis basis =
      closed ? PeriodicUniformKnots(3, spans, 0, 1) : SplineBasis::Uniform(3, spans + 3, 0, 1);
  Eigen::MatrixXd net(2, basis.size());
  for (int i = 0; i < basis.size(); ++i) net.col(i) = Flower(turn * basis.Greville(i));
  for (int i = spans; closed && i < basis.size(); ++i) net.col(i) = net.col(i - spans);
  return {FittingProblem(basis, data, 0), net};
}

// Anything: any degree, dimension, scatter, weights, parameters; spikes, cusps and loops.
Case RandomCase(RandomSplines& random) {
  const int degree = random.Integer(1, 5), dimension = random.Integer(2, 3);
  BasisKind kind;
  kind.most_spans = 8;
  kind.highest_multiplicity = random.Integer(1, degree);
  kind.periodic = random.Coin();
  const SplineBasis basis = random.Basis(degree, kind);
  const int count = random.Integer(1, 150);
  auto data = std::make_shared<FittingData>();
  data->values.resize(dimension, count);
  data->parameters = Eigen::Matrix2Xd::Zero(2, count);
  const double spread = random.Logarithmic(1e-3, 3), frequency = random.Real(1, 6);
  for (int k = 0; k < count; ++k) {
    const double u = random.Real(basis.lower(), basis.upper());
    data->parameters(0, k) = u;
    for (int i = 0; i < dimension; ++i) {
      data->values(i, k) = std::sin(frequency * u + i) + spread * random.Real(-1, 1);
    }
  }
  if (random.Coin()) {
    data->weights.resize(count);
    for (double& w : data->weights) w = random.Integer(0, 5) == 0 ? 0 : random.Logarithmic(0.1, 10);
    data->weights[0] = 1;
  }
  Eigen::MatrixXd net(dimension, basis.size());
  for (double& x : net.reshaped()) x = random.Real(-1, 1);
  const int round = basis.size() - degree;
  for (int i = round; basis.periodic() && i < basis.size(); ++i) net.col(i) = net.col(i - round);
  const double smoothing = random.Coin() ? 0 : random.Logarithmic(1e-10, 1e-2);
  return {FittingProblem(basis, data, smoothing), net};
}

TEST(DistanceMinimisationTest, NeverMakesTheFitWorse) {
  RandomSplines random(1);
  for (int trial = 0; trial < 300; ++trial) {
    SCOPED_TRACE("seed 1, trial " + std::to_string(trial));
    const Case c = RandomCase(random);
    const bool smooth = c.problem.smoothing() > 0;
    for (const DistanceModel model : kModels) {
      double last = HUGE_VAL;
      const DistanceMinimum result = Minimise(c.problem, c.net, Options(model, 20, 0));
      for (const double rms : result.rms) {
        if (!smooth) {
          EXPECT_LE(rms, last);
        }
        EXPECT_TRUE(std::isfinite(rms));
        last = rms;
      }
      EXPECT_TRUE(result.control_points.allFinite());
      // The report is of the net returned.
      const FittingData& data = c.problem.data();
      double squares = 0, weights = 0;
      const SplineBasis& basis = c.problem.basis_u();
      for (Eigen::Index k = 0; k < c.problem.size(); ++k) {
        const double u = result.parameters[k], w = data.weights.size() > 0 ? data.weights[k] : 1;
        Eigen::VectorXd at(data.values.rows());
        if (at.size() == 2) {
          at = NurbsCurve<2>(basis, result.control_points).At(u);
        } else {
          at = NurbsCurve<3>(basis, result.control_points).At(u);
        }
        squares += w * (at - data.values.col(k)).squaredNorm();
        weights += w;
      }
      EXPECT_NEAR(std::sqrt(squares / weights), result.rms.back(), kIterated);
    }
  }
}

TEST(DistanceMinimisationTest, FindsTheCurveThatThePointsLieOn) {
  RandomSplines random(2);
  for (int trial = 0; trial < 12; ++trial) {
    SCOPED_TRACE("seed 2, trial " + std::to_string(trial));
    const Case flower = FlowerCase(trial % 2 == 0, 600, 30, 0, 2);
    const SplineBasis& basis = flower.problem.basis_u();
    const NurbsCurve<2> truth(basis, flower.net);
    auto data = std::make_shared<FittingData>(flower.problem.data());
    for (Eigen::Index k = 0; k < data->values.cols(); ++k) {
      data->values.col(k) = truth.At(random.Real(0, 1));
      const CurveFootPoints<2> feet(truth);
      data->parameters(0, k) = feet.Nearest({data->values(0, k), data->values(1, k), 0}).u;
    }
    Eigen::MatrixXd net = flower.net;
    for (double& x : net.reshaped()) x += random.Real(-0.01, 0.01);
    for (int i = 30; basis.periodic() && i < basis.size(); ++i) net.col(i) = net.col(i - 30);
    for (const DistanceModel model : {DistanceModel::kTangent, DistanceModel::kSquared}) {
      const DistanceMinimum result =
          Minimise(FittingProblem(basis, data, 0), net, Options(model, 100, 0));
      EXPECT_LT(result.rms.back(), kHalfDigits);
    }
  }
}

TEST(DistanceMinimisationTest, PointDistancesAreTheLinearFitAtTheFeet) {
  for (const double smoothing : {0.0, 1e-6}) {
    const Case c = FlowerCase(false, 800, 30, 0.01, 3);
    ThreadPool pool(1);
    const DistanceMinimum feet = Minimise(c.problem, c.net, Options(DistanceModel::kPoint, 0));
    EXPECT_EQ(feet.rms.size(), 1u);
    EXPECT_EQ(feet.control_points, c.net);
    Eigen::Matrix2Xd parameters = Eigen::Matrix2Xd::Zero(2, 800);
    parameters.row(0) = feet.parameters.transpose();
    const FittingProblem there(
        c.problem.basis_u(), c.problem.WithParameters(parameters).shared_data(), smoothing);
    const DistanceMinimum one = Minimise(there, c.net, Options(DistanceModel::kPoint, 1));
    const Eigen::MatrixXd linear = SolveLinear(there, pool).coefficients;
    EXPECT_LT((one.control_points - linear).norm(), kIterated * linear.norm());
  }
}

// The gradient of Σ w |r|² by the net is Σ w N r: with feet at their places nothing else counts.
// Point distances creep towards that for tens of thousands of rounds.
TEST(DistanceMinimisationTest, EndsWhereTheGradientVanishes) {
  for (const bool closed : {true, false}) {
    for (const DistanceModel model : {DistanceModel::kTangent, DistanceModel::kSquared}) {
      const Case c = FlowerCase(closed, 600, 16, 0.003, 4);
      const DistanceMinimum result = Minimise(c.problem, c.net, Options(model, 3000, 1e-15));
      const SplineBasis& basis = c.problem.basis_u();
      const NurbsCurve<2> curve(basis, result.control_points);
      const int different = closed ? 16 : basis.size();
      Eigen::Matrix2Xd gradient = Eigen::Matrix2Xd::Zero(2, different);
      for (Eigen::Index k = 0; k < 600; ++k) {
        const double u = result.parameters[k];
        const Eigen::Vector2d r = curve.At(u) - c.problem.data().values.col(k);
        double values[4];
        const int span = basis.Span(u);
        basis.Values(span, u, values);
        for (int i = 0; i <= 3; ++i) gradient.col((span - 3 + i) % different) += values[i] * r;
      }
      EXPECT_LT(gradient.norm(), kHalfDigits * result.rms.back() * 600);
    }
  }
}

// A net over shifted knots: the same curve, its seam elsewhere.
TEST(DistanceMinimisationTest, TheSeamIsAPlaceLikeAnyOther) {
  constexpr int kSpans = 20, kShift = 7;
  const Case c = FlowerCase(true, 500, kSpans, 0.01, 5);
  Case other = c;
  auto data = std::make_shared<FittingData>(c.problem.data());
  for (double& u : data->parameters.row(0)) {
    u -= static_cast<double>(kShift) / kSpans;
    u -= std::floor(u);
  }
  for (int i = 0; i < c.net.cols(); ++i) other.net.col(i) = c.net.col((i + kShift) % kSpans);
  other.problem = c.problem.WithData(data);
  for (const DistanceModel model : kModels) {
    const DistanceMinimum a = Minimise(c.problem, c.net, Options(model, 10, 0));
    const DistanceMinimum b = Minimise(other.problem, other.net, Options(model, 10, 0));
    for (int i = 0; i < kSpans; ++i) {
      EXPECT_LT((b.control_points.col(i) - a.control_points.col((i + kShift) % kSpans)).norm(),
                kHalfDigits);
    }
    EXPECT_EQ(a.control_points.leftCols(3), a.control_points.rightCols(3));
  }
}

TEST(DistanceMinimisationTest, TurnsAndScalesWithTheData) {
  RandomSplines random(6);
  for (const bool closed : {true, false}) {
    const Case c = FlowerCase(closed, 500, 24, 0.01, 6);
    const double scale = random.Logarithmic(1e-6, 1e6);
    const Eigen::Matrix2d turn = scale * Eigen::Rotation2Dd(1).toRotationMatrix();
    auto data = std::make_shared<FittingData>(c.problem.data());
    data->values = turn * data->values;
    for (const DistanceModel model : kModels) {
      const DistanceMinimum a = Minimise(c.problem, c.net, Options(model, 10, 0));
      const DistanceMinimum b =
          Minimise(c.problem.WithData(data), turn * c.net, Options(model, 10, 0));
      EXPECT_LT((b.control_points - turn * a.control_points).norm(), kHalfDigits * scale);
    }
  }
}

TEST(DistanceMinimisationTest, SlidingFeetGetThereSooner) {
  for (const bool closed : {true, false}) {
    for (const double sigma : {0.0, 1e-3}) {
      const Case c = FlowerCase(closed, 4000, 40, sigma, 7);
      const double slow =
          Minimise(c.problem, c.net, Options(DistanceModel::kPoint, 100, 0)).rms.back();
      for (const DistanceModel model : {DistanceModel::kTangent, DistanceModel::kSquared}) {
        EXPECT_LT(Minimise(c.problem, c.net, Options(model, 25, 0)).rms.back(), slow);
      }
    }
  }
}

TEST(DistanceMinimisationTest, WorksInSpaceAndWithEveryNumberOfThreads) {
  std::mt19937_64 engine(8);
  std::normal_distribution<double> noise(0, 1);
  auto data = std::make_shared<FittingData>();
  constexpr int kCount = 9000;
  data->values.resize(3, kCount);
  data->parameters = Eigen::Matrix2Xd::Zero(2, kCount);
  const auto helix = [](double t) { return Eigen::Vector3d(std::cos(t), std::sin(t), 0.2 * t); };
  for (int k = 0; k < kCount; ++k) {
    const double s = k / (kCount - 1.0);
    data->values.col(k) = helix(12 * s);
    for (int i = 0; i < 3; ++i) data->values(i, k) += 0.002 * noise(engine);
    data->parameters(0, k) = s + 0.01 * std::sin(3 * std::numbers::pi * s);
  }
  const SplineBasis basis = SplineBasis::Uniform(3, 40, 0, 1);
  Eigen::MatrixXd net(3, 40);
  for (int i = 0; i < 40; ++i) net.col(i) = helix(12 * basis.Greville(i));
  const FittingProblem problem(basis, data, 1e-10);
  for (const DistanceModel model : kModels) {
    ThreadPool one(1), two(2);
    const DistanceMinimum a = MinimiseDistance(problem, net, Options(model), one);
    const DistanceMinimum b = MinimiseDistance(problem, net, Options(model), two);
    EXPECT_EQ(a.control_points, b.control_points);
    EXPECT_EQ(a.parameters, b.parameters);
    EXPECT_LT(a.rms.back(), 1.01 * 0.002 * std::sqrt(2));  // two components across the curve
    double truth = 0;
    const CurveFootPoints<3> feet(NurbsCurve<3>(basis, a.control_points));
    for (int k = 20; k < 480; ++k)
      truth += std::pow(feet.Nearest(helix(12 * k / 500.0)).distance, 2);
    EXPECT_LT(std::sqrt(truth / 460), 4e-4);
  }
}

TEST(DistanceMinimisationTest, StopsWhenAsked) {
  const Case c = FlowerCase(true, 500, 24, 0.01, 9);
  DistanceMinimisationOptions options = Options(DistanceModel::kSquared);
  options.progress = [](const char*, double fraction) { return fraction < 0.05; };
  const DistanceMinimum result = Minimise(c.problem, c.net, options);
  EXPECT_FALSE(result.converged);
  EXPECT_GT(result.rounds, 0);
  EXPECT_LT(result.rounds, 10);
}

void ExpectRefused(const FittingProblem& problem,
                   const Eigen::MatrixXd& net,
                   const DistanceMinimisationOptions& options,
                   const std::string& reason) {
  try {
    Minimise(problem, net, options);
    ADD_FAILURE() << "not refused: " << reason;
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(), HasSubstr(reason));
  }
}

TEST(DistanceMinimisationTest, RefusesBrokenPreconditions) {
  const Case c = FlowerCase(true, 50, 12, 0.01, 10);
  const DistanceMinimisationOptions good;
  ExpectRefused(c.problem, c.net.leftCols(9), good, "net does not fit");
  ExpectRefused(c.problem, Eigen::MatrixXd::Zero(3, 15), good, "net does not fit");
  Eigen::MatrixXd torn = c.net;
  torn(0, 0) += 1;
  ExpectRefused(c.problem, torn, good, "");
  ExpectRefused(c.problem, c.net, Options(DistanceModel::kPoint, -1), "max_rounds");
  ExpectRefused(c.problem, c.net, Options(DistanceModel::kPoint, 1, -1), "relative_gain");
  DistanceMinimisationOptions bad;
  bad.damping = 0;
  ExpectRefused(c.problem, c.net, bad, "damping");
}

}  // namespace batten::internal::distance_minimisation_test
