// SPDX-License-Identifier: MIT
#include "fitting/curve/knot_relocation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "random_splines.h"
#include "tolerances.h"

#include "batten/fitting/solve_linear.h"

namespace batten::internal::knot_relocation_test {

// No span gets narrower than that share of its first width.
constexpr double kNarrowest = 0.7;

struct Case {
  SpanLayout layout;
  FittingProblem problem;
};

// A wave with a sharp bend and noise, in the plane or in space, data in any order.
Case RandomCase(unsigned seed, int count, double noise) {
  RandomSplines random(seed);
  const int degree = random.Integer(1, 5), spans = random.Integer(degree + 1, 12),
            dimension = random.Integer(1, 3);
  const bool closed = random.Coin();
  std::vector<double> corners;
  if (random.Coin()) corners.push_back(random.Real(0.4, 0.6));
  if (closed && random.Coin()) corners.push_back(0);
  SpanLayout layout = SpanLayout::Equal(degree, spans, 0, 1, corners, closed);
  auto data = std::make_shared<FittingData>();
  data->parameters = Eigen::Matrix2Xd::Zero(2, count);
  data->values.resize(dimension, count);
  const double bend = random.Real(0.1, 0.9);
  for (int k = 0; k < count; ++k) {
    const double u = k == 0 ? 0 : k == 1 ? 1 : random.Real(0, 1);
    data->parameters(0, k) = u;
    for (int d = 0; d < dimension; ++d) {
      data->values(d, k) = std::sin(6.283185307179586 * (d + 1) * u) +
                           std::atan(30 * (u - bend)) * u * (1 - u) + noise * random.Real(-1, 1);
    }
  }
  if (random.Coin()) {
    data->weights.resize(count);
    for (double& w : data->weights) w = random.Integer(0, 4) == 0 ? 0 : random.Real(0.5, 2);
  }
  FittingProblem problem(layout.Basis(), std::move(data), 0);
  return {std::move(layout), std::move(problem)};
}

void ForCases(const std::function<void(const Case&)>& law, double noise = 0.05) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    law(RandomCase(seed, 1500, noise));
    if (testing::Test::HasFailure()) return;
  }
}

// A layout with every inner break that is no corner moved by up to a share of the spans beside it.
SpanLayout Shaken(RandomSplines& random, const SpanLayout& layout, double share) {
  std::vector<double> breaks = layout.breaks();
  for (int k = 1; k < layout.spans(); ++k) {
    if (layout.IsCorner(k)) continue;
    const auto i = static_cast<size_t>(k);
    const std::vector<double>& old = layout.breaks();
    const double shift = random.Real(-share, share);
    breaks[i] += shift * (shift < 0 ? old[i] - old[i - 1] : old[i + 1] - old[i]);
  }
  return layout.WithBreaks(std::move(breaks));
}

// The problem of the means that the trials take: blocks of about equally many, by parameters.
FittingProblem Means(const FittingProblem& problem, size_t count) {
  std::vector<Eigen::Index> order(static_cast<size_t>(problem.size()));
  for (size_t k = 0; k < order.size(); ++k) order[k] = static_cast<Eigen::Index>(k);
  std::stable_sort(order.begin(), order.end(), [&](Eigen::Index a, Eigen::Index b) {
    return problem.data().parameters(0, a) < problem.data().parameters(0, b);
  });
  auto data = std::make_shared<FittingData>();
  const auto blocks = static_cast<Eigen::Index>(count);
  data->parameters = Eigen::Matrix2Xd::Zero(2, blocks);
  data->values = Eigen::MatrixXd::Zero(problem.data().values.rows(), blocks);
  data->weights = Eigen::VectorXd::Zero(blocks);
  for (Eigen::Index b = 0; b < blocks; ++b) {
    for (Eigen::Index k = b * problem.size() / blocks; k < (b + 1) * problem.size() / blocks; ++k) {
      const Eigen::Index from = order[static_cast<size_t>(k)];
      const double w = problem.data().weights.size() > 0 ? problem.data().weights[from] : 1;
      data->parameters(0, b) += w * problem.data().parameters(0, from);
      data->values.col(b) += w * problem.data().values.col(from);
      data->weights[b] += w;
    }
    data->parameters(0, b) = std::min(1.0, data->parameters(0, b) / data->weights[b]);
    data->values.col(b) /= data->weights[b];
  }
  return problem.WithData(std::move(data));
}

double Solved(const FittingProblem& problem, const SpanLayout& layout) {
  ThreadPool pool(1);
  return SolveLinear(problem.WithBasis(layout.Basis()), pool).residual_squares;
}

TEST(LayoutTrialsTest, HaveTheSquaresOfTheMeansUpToAConstant) {
  ForCases([](const Case& given) {
    const int spans = given.layout.spans() + 4;
    const LayoutTrials trials(given.problem, spans);
    const FittingProblem means = Means(given.problem, static_cast<size_t>(10 * spans));
    RandomSplines random(8);
    const double weight = means.data().weights.sum();
    for (int k = 0; k < 4; ++k) {
      const SpanLayout one = Shaken(random, given.layout, 0.3),
                       other = Shaken(random, given.layout, 0.3);
      EXPECT_NEAR(trials.Squares(one) - trials.Squares(other),
                  Solved(means, one) - Solved(means, other),
                  kIterated * weight);
    }
  });
}

TEST(LayoutTrialsTest, KnowTheDifferenceThatAllDataMakeWhereSpansAreWide) {
  ForCases([](const Case& given) {
    // As many means as data.
    const LayoutTrials trials(given.problem, 150);
    RandomSplines random(8);
    const SpanLayout one = Shaken(random, given.layout, 0.3),
                     other = Shaken(random, given.layout, 0.3);
    EXPECT_NEAR(trials.Squares(one) - trials.Squares(other),
                Solved(given.problem, one) - Solved(given.problem, other),
                kIterated * static_cast<double>(given.problem.size()));
  });
}

TEST(LayoutTrialsTest, SayWhereTheDataDoNotDetermineTheCurve) {
  auto data = std::make_shared<FittingData>();
  data->parameters = Eigen::Matrix2Xd::Zero(2, 100);
  data->values = Eigen::MatrixXd::Ones(2, 100);
  for (Eigen::Index k = 0; k < 100; ++k)
    data->parameters(0, k) = static_cast<double>(k) / 100 * 0.4;
  const SpanLayout layout = SpanLayout::Equal(3, 20, 0, 1, {}, false);
  const LayoutTrials trials(FittingProblem(layout.Basis(), data, 0), 20);
  EXPECT_EQ(trials.Squares(layout), std::numeric_limits<double>::infinity());
}

void ExpectRelocated(const Case& given, const SpanLayout& moved) {
  const SpanLayout& start = given.layout;
  EXPECT_EQ(moved.degree(), start.degree());
  EXPECT_EQ(moved.closed(), start.closed());
  EXPECT_EQ(moved.corners(), start.corners());
  ASSERT_EQ(moved.spans(), start.spans());
  EXPECT_EQ(moved.breaks().front(), start.breaks().front());
  EXPECT_EQ(moved.breaks().back(), start.breaks().back());
  for (size_t k = 0; k + 1 < moved.breaks().size(); ++k) {
    EXPECT_GE(moved.breaks()[k + 1] - moved.breaks()[k],
              (kNarrowest - kRounding) * (start.breaks()[k + 1] - start.breaks()[k]));
  }
}

TEST(RelocateKnotsTest, KeepsEndsAndCornersAndSpansOfSomeWidth) {
  ForCases([](const Case& given) {
    const LayoutTrials trials(given.problem, given.layout.spans());
    ExpectRelocated(given, RelocateKnots(trials, given.layout));
  });
}

TEST(RelocateKnotsTest, DoesNotMakeTheSquaresRise) {
  ForCases([](const Case& given) {
    const LayoutTrials trials(given.problem, given.layout.spans());
    const SpanLayout moved = RelocateKnots(trials, given.layout);
    EXPECT_LE(trials.Squares(moved), trials.Squares(given.layout));
    // And again from there.
    EXPECT_LE(trials.Squares(RelocateKnots(trials, moved)), trials.Squares(moved));
  });
}

TEST(RelocateKnotsTest, MovesAKnotTowardsAKink) {
  for (const double kink : {0.45, 0.48, 0.53, 0.56}) {
    SCOPED_TRACE("kink " + std::to_string(kink));
    auto data = std::make_shared<FittingData>();
    data->parameters = Eigen::Matrix2Xd::Zero(2, 2000);
    data->values.resize(1, 2000);
    for (Eigen::Index k = 0; k < 2000; ++k) {
      const double u = (static_cast<double>(k) + 0.5) / 2000;
      data->parameters(0, k) = u;
      data->values(0, k) = std::abs(u - kink);
    }
    const SpanLayout layout = SpanLayout::Equal(1, 4, 0, 1, {}, false);
    const FittingProblem problem(layout.Basis(), data, 0);
    const LayoutTrials trials(problem, 40);
    const SpanLayout moved = RelocateKnots(trials, layout);
    EXPECT_LT(trials.Squares(moved), trials.Squares(layout));
  }
}

TEST(RelocateKnotsTest, LeavesWhatHasNoInnerKnots) {
  const Case given = RandomCase(1, 1500, 0.01);
  const SpanLayout bare = SpanLayout::Equal(2, 2, 0, 1, {0.5}, false);
  const LayoutTrials trials(given.problem, 5);
  EXPECT_EQ(RelocateKnots(trials, bare).breaks(), bare.breaks());
}

// Powers of two change no digit.
TEST(RelocateKnotsTest, DoesNotKnowTheUnit) {
  for (const double unit : {std::ldexp(1, -20), std::ldexp(1, 20)}) {
    ForCases([&](const Case& given) {
      auto data = std::make_shared<FittingData>(given.problem.data());
      data->values *= unit;
      const LayoutTrials one(given.problem, given.layout.spans()),
          other(given.problem.WithData(data), given.layout.spans());
      EXPECT_EQ(RelocateKnots(one, given.layout).breaks(),
                RelocateKnots(other, given.layout).breaks());
    });
  }
}

TEST(RelocateKnotsTest, DoesNotKnowDataWithoutWeight) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const Case given = RandomCase(seed, 600, 0.02);
    // As many means as data: no mean holds both kinds.
    const auto with = std::make_shared<FittingData>(), without = std::make_shared<FittingData>();
    RandomSplines random(seed);
    const Eigen::Index count = given.problem.size();
    with->parameters = given.problem.data().parameters;
    with->values = given.problem.data().values;
    with->weights = Eigen::VectorXd::Ones(count);
    without->parameters.resize(2, count);
    without->values.resize(with->values.rows(), count);
    Eigen::Index kept = 0;
    for (Eigen::Index k = 0; k < count; ++k) {
      if (random.Integer(0, 3) == 0) {
        with->weights[k] = 0;
        with->values.col(k).setConstant(1e3);
        continue;
      }
      without->parameters.col(kept) = with->parameters.col(k);
      without->values.col(kept++) = with->values.col(k);
    }
    without->parameters.conservativeResize(2, kept);
    without->values.conservativeResize(Eigen::NoChange, kept);
    const LayoutTrials a(given.problem.WithData(with), 60), b(given.problem.WithData(without), 60);
    const SpanLayout shaken = Shaken(random, given.layout, 0.3);
    EXPECT_NEAR(a.Squares(shaken), b.Squares(shaken), kIterated * static_cast<double>(count));
  }
}

}  // namespace batten::internal::knot_relocation_test
