// SPDX-License-Identifier: MIT
#include "batten/fitting/residual_term.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "fitting/joint/eliminated_problem.h"
#include "fitting/joint/term_cost.h"
#include "joint_runs.h"
#include "tolerances.h"

namespace batten::internal::residual_term_test {

using testing::HasSubstr;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

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
    EliminatedProblem cells(c.problem, c.net, c.weights, options, pool);
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
    EXPECT_TRUE(with.control_points == without.control_points);
    EXPECT_EQ(with.iterations, without.iterations);
    const double squares = 1e-4 * static_cast<double>(c.net.rows());
    EXPECT_NEAR(with.misfit_after - without.misfit_after,
                squares,
                kIterated * (squares + without.misfit_after));
  });
}

}  // namespace batten::internal::residual_term_test
