// SPDX-License-Identifier: MIT
#include "fitting/knots/block_validation.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>
#include <random>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "batten/fitting/solve_linear.h"
#include "fitting/knots/knot_grid_selection.h"
#include "fitting/least_squares/fitting_bases.h"
#include "random_splines.h"
#include "tolerances.h"

namespace batten::internal::block_validation_test {

// Random points with a smooth shape, of one or three components, on [low, low + (3, 2)].
FittingProblem Sheet(int count,
                     int components,
                     unsigned seed,
                     bool weighted = false,
                     double low = 0,
                     double smoothing = 1e-4) {
  RandomSplines random(seed);
  auto data = std::make_shared<FittingData>();
  data->parameters.resize(2, count);
  data->values.resize(components, count);
  if (weighted) data->weights.resize(count);
  for (int k = 0; k < count; ++k) {
    const double u = random.Real(0, 3), v = random.Real(0, 2);
    data->parameters.col(k) << low + u, low + v;
    for (int d = 0; d < components; ++d)
      data->values(d, k) = std::sin(2 * u + d) * std::cos(v) + random.Real(-0.1, 0.1);
    if (weighted) data->weights[k] = random.Real(0.5, 2);
  }
  return FittingProblem(FittingBasis(3, 1, low, low + 3),
                        FittingBasis(3, 1, low, low + 2),
                        std::move(data),
                        smoothing);
}

// The subset of a problem's data.
FittingProblem Only(const FittingProblem& problem, const std::vector<Eigen::Index>& points) {
  auto data = std::make_shared<FittingData>();
  data->parameters = problem.data().parameters(Eigen::all, points);
  data->values = problem.data().values(Eigen::all, points);
  if (problem.data().weights.size() > 0) data->weights = problem.data().weights(points);
  return problem.WithData(std::move(data));
}

// Tiles half a width off the corner, every fifth in a fold: as the header promises, by hand.
std::pair<int, int> TileOf(const FittingProblem& problem, Eigen::Index k, double width) {
  return {
      static_cast<int>((problem.data().parameters(0, k) - problem.basis_u().lower()) / width + 0.5),
      static_cast<int>((problem.data().parameters(1, k) - problem.basis_v().lower()) / width +
                       0.5)};
}

TEST(BlockValidationTest, SumsWhatFitsWithoutABlockMissItBy) {
  for (unsigned seed = 0; seed < 12; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const int components = seed % 2 == 0 ? 1 : 3;
    // Without fairness, whose scale depends on which points there are.
    const FittingProblem problem = Sheet(900, components, seed, seed % 3 == 0, 0, 0);
    const double width = random.Real(0.2, 0.5);
    const SplineBasis basis_u = FittingBasis(random.Integer(2, 4), random.Integer(1, 4), 0, 3),
                      basis_v = FittingBasis(random.Integer(2, 4), random.Integer(1, 4), 0, 2);
    ThreadPool pool(1);
    const BlockValidation validation(problem, width);
    const Eigen::VectorXd errors = validation.Errors(basis_u, basis_v, pool);
    ASSERT_EQ(errors.size(), validation.blocks());
    double expected = 0;
    for (int fold = 0; fold < 5; ++fold) {
      std::vector<Eigen::Index> inside, outside;
      for (Eigen::Index k = 0; k < problem.size(); ++k) {
        const auto [i, j] = TileOf(problem, k, width);
        ((i + 2 * j) % 5 == fold ? outside : inside).push_back(k);
      }
      const FittingProblem rest = Only(problem, inside).WithBases(basis_u, basis_v);
      const FittingProblem left_out = Only(problem, outside).WithBases(basis_u, basis_v);
      const Eigen::MatrixXd foreseen =
          EvaluateAt(left_out, SolveLinear(rest, pool).coefficients, pool);
      const Eigen::VectorXd squares =
          (foreseen - left_out.data().values).colwise().squaredNorm().transpose();
      expected +=
          left_out.data().weights.size() > 0 ? left_out.data().weights.dot(squares) : squares.sum();
    }
    // Rounding times the condition of a normal matrix with cells that hold few points.
    EXPECT_NEAR(errors.sum(), expected, kHalfDigits * expected);
  }
}

TEST(BlockValidationTest, DoesNotDependOnTheOrderOfPointsOrOnThreads) {
  const FittingProblem problem = Sheet(2000, 3, 1, true);
  std::vector<Eigen::Index> order(2000);
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  std::shuffle(order.begin(), order.end(), std::mt19937_64(2));
  const SplineBasis basis_u = FittingBasis(3, 6, 0, 3), basis_v = FittingBasis(3, 4, 0, 2);
  ThreadPool one(1), three(3);
  const Eigen::VectorXd errors = BlockValidation(problem, 0.3).Errors(basis_u, basis_v, one);
  EXPECT_EQ(BlockValidation(problem, 0.3).Errors(basis_u, basis_v, three), errors);
  const Eigen::VectorXd shuffled =
      BlockValidation(Only(problem, order), 0.3).Errors(basis_u, basis_v, one);
  EXPECT_LE((shuffled - errors).norm(), kIterated * errors.norm());
}

TEST(BlockValidationTest, CountsAWeightOfTwoAsTwoPoints) {
  const FittingProblem problem = Sheet(1000, 1, 3);
  std::vector<Eigen::Index> twice(2000);
  for (size_t k = 0; k < twice.size(); ++k) twice[k] = static_cast<Eigen::Index>(k % 1000);
  const SplineBasis basis_u = FittingBasis(3, 5, 0, 3), basis_v = FittingBasis(3, 4, 0, 2);
  ThreadPool pool(1);
  const Eigen::VectorXd weighted =
      BlockValidation(problem.WithWeights(Eigen::VectorXd::Constant(1000, 2)), 0.3)
          .Errors(basis_u, basis_v, pool);
  const Eigen::VectorXd doubled =
      BlockValidation(Only(problem, twice), 0.3).Errors(basis_u, basis_v, pool);
  EXPECT_LE((weighted - doubled).norm(), kIterated * doubled.norm());
}

TEST(BlockValidationTest, GoesWithTheSquareOfTheUnitAndHoldsFarFromTheOrigin) {
  const FittingProblem problem = Sheet(1500, 1, 4);
  ThreadPool pool(1);
  const Eigen::VectorXd errors =
      BlockValidation(problem, 0.4)
          .Errors(FittingBasis(3, 5, 0, 3), FittingBasis(3, 3, 0, 2), pool);
  for (const double unit : {1e-6, 1e6}) {
    auto data = std::make_shared<FittingData>(problem.data());
    data->parameters =
        (unit * data->parameters).cwiseMin(Eigen::Vector2d(3 * unit, 2 * unit).replicate(1, 1500));
    data->values *= unit;
    const FittingProblem scaled(
        FittingBasis(3, 1, 0, 3 * unit), FittingBasis(3, 1, 0, 2 * unit), data, 1e-4);
    const Eigen::VectorXd there =
        BlockValidation(scaled, 0.4 * unit)
            .Errors(FittingBasis(3, 5, 0, 3 * unit), FittingBasis(3, 3, 0, 2 * unit), pool);
    EXPECT_NEAR(there.sum(), unit * unit * errors.sum(), kHalfDigits * unit * unit * errors.sum());
  }
}

TEST(BlockValidationTest, SeesThatDetailNarrowerThanABlockCannotBeForeseen) {
  // Noise that is one number to a tile: coarse bases foresee it no worse than fine ones do.
  const FittingProblem clean = Sheet(6000, 1, 5);
  auto data = std::make_shared<FittingData>(clean.data());
  RandomSplines random(6);
  std::vector<double> noise(40 * 40);
  for (double& n : noise) n = random.Real(-1, 1);
  for (Eigen::Index k = 0; k < 6000; ++k) {
    const auto [i, j] = TileOf(clean, k, 0.1);
    data->values(0, k) = noise[static_cast<size_t>(40 * i + j)];
  }
  const FittingProblem problem = clean.WithData(std::move(data));
  ThreadPool pool(1);
  const BlockValidation validation(problem, 0.3);
  const auto error = [&](int cells) {
    return validation
        .Errors(FittingBasis(3, 3 * cells, 0, 3), FittingBasis(3, 2 * cells, 0, 2), pool)
        .sum();
  };
  const double coarse = error(1);
  for (const int cells : {4, 8, 12}) EXPECT_GT(error(cells), coarse);
}

TEST(BlockValidationTest, RefusesCurvesAndBlocksOfNoWidth) {
  const FittingProblem problem = Sheet(100, 1, 7);
  EXPECT_THROW(BlockValidation(problem, 0), std::invalid_argument);
  EXPECT_THROW(BlockValidation(problem, -1), std::invalid_argument);
  EXPECT_THROW(BlockValidation(problem, std::numeric_limits<double>::quiet_NaN()),
               std::invalid_argument);
  const FittingProblem curve(
      FittingBasis(3, 1, 0, 3),
      std::make_shared<FittingData>(FittingData{
          Eigen::Matrix2Xd::Zero(2, 5), Eigen::MatrixXd::Zero(2, 5), Eigen::VectorXd()}),
      0);
  EXPECT_THROW(BlockValidation(curve, 1), std::invalid_argument);
}

TEST(ParameterSpacingTest, IsTheSideOfThePartThatAPointHasToItself) {
  for (const int count : {500, 5000, 50000}) {
    // A tenth: tiles are missed by chance, and those at the rim are cut.
    const FittingProblem everywhere = Sheet(count, 1, 8);
    EXPECT_NEAR(ParameterSpacing(everywhere), std::sqrt(6.0 / count), 0.1 * std::sqrt(6.0 / count));
    std::vector<Eigen::Index> left;
    for (Eigen::Index k = 0; k < count; ++k) {
      if (everywhere.data().parameters(0, k) < 1) left.push_back(k);
    }
    // A strip of the domain: tiles at its rim count whole.
    const double spacing = std::sqrt(2.0 / std::ssize(left));
    EXPECT_NEAR(ParameterSpacing(Only(everywhere, left)), spacing, 0.3 * spacing);
  }
}

}  // namespace batten::internal::block_validation_test
