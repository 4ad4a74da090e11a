// SPDX-License-Identifier: MIT
#include "fitting/joint/gauss_newton_system.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "fitting/joint/joint_kernels.h"
#include "joint_cases.h"
#include "tolerances.h"

namespace batten::internal::gauss_newton_system_test {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

TEST(JointKernelsTest, AddsWhatPlainSumsSay) {
  RandomSplines random(1);
  for (const int p : {0, 1, 2, 3, 4, 9, 25}) {
    for (const int q : {0, 1, 2, 3, 9}) {
      for (const int count : {0, 1, 15, 16, 17, 50}) {
        SCOPED_TRACE(testing::Message() << "degrees " << p << ", " << q << ", points " << count);
        const auto numbers = [&](int size) {
          std::vector<double> all(static_cast<size_t>(size));
          for (double& x : all) x = random.Real(-1, 1);
          return all;
        };
        const std::vector<double> Nu = numbers(count * (p + 1)), Nv = numbers(count * (q + 1)),
                                  metrics = numbers(count * kMetricLanes),
                                  of_points = numbers(count * kPullLanes);
        const std::vector<double> pairs_before =
            numbers(PairCount(p) * PairCount(q) * kMetricLanes);
        const std::vector<double> pulls_before = numbers((p + 1) * (q + 1) * kPullLanes);
        std::vector<double> pairs = pairs_before, pulls = pulls_before;
        AddCellProducts(p,
                        q,
                        Nu.data(),
                        Nv.data(),
                        metrics.data(),
                        of_points.data(),
                        count,
                        pairs.data(),
                        pulls.data());
        double worst = 0;
        for (int r = 0; r <= p; ++r) {
          for (int s = 0; s <= q; ++s) {
            for (int d = 0; d < kPullLanes; ++d) {
              const auto at = static_cast<size_t>((r * (q + 1) + s) * kPullLanes + d);
              double sum = pulls_before[at];
              for (int k = 0; k < count; ++k) {
                sum += Nu[k * (p + 1) + r] * Nv[k * (q + 1) + s] * of_points[k * kPullLanes + d];
              }
              worst = std::max(worst, std::abs(sum - pulls[at]));
            }
            for (int r2 = r; r2 <= p; r2 += 3) {
              for (int s2 = s; s2 <= q; s2 += 2) {
                const int pair = PairIndex(q, s, s2) * PairCount(p) + PairIndex(p, r, r2);
                for (int e = 0; e < kMetricLanes; ++e) {
                  const auto at = static_cast<size_t>(pair * kMetricLanes + e);
                  double sum = pairs_before[at];
                  for (int k = 0; k < count; ++k) {
                    sum += Nu[k * (p + 1) + r] * Nu[k * (p + 1) + r2] * Nv[k * (q + 1) + s] *
                           Nv[k * (q + 1) + s2] * metrics[k * kMetricLanes + e];
                  }
                  worst = std::max(worst, std::abs(sum - pairs[at]));
                }
              }
            }
          }
        }
        // Terms are below one, and so is the start.
        EXPECT_LE(worst, (count + 4) * 4 * std::numeric_limits<double>::epsilon());
      }
    }
  }
}

// Σ JᵀJ and Σ Jᵀr over the cells' rows, as Ceres would add them up; the unknowns of a block stand
// together.
struct Dense {
  explicit Dense(const EliminatedProblem& cells) {
    const int dim = cells.dimension(), n = dim * cells.blocks();
    matrix = Eigen::MatrixXd::Zero(n, n);
    gradient = Eigen::VectorXd::Zero(n);
    Eigen::VectorXd residual(cells.rows());
    RowMajor J(cells.rows(), cells.columns());
    for (int cell = 0; cell < cells.cells(); ++cell) {
      cells.Evaluate(cell, residual.data(), J.data());
      RowMajor whole = RowMajor::Zero(cells.rows(), n);
      int column = 0;
      for (const int block : cells.BlocksOf(cell)) {
        whole.middleCols(dim * block, dim) += J.middleCols(column, dim);
        column += dim;
      }
      matrix += whole.transpose() * whole;
      gradient += whole.transpose() * residual;
    }
  }

  Eigen::MatrixXd matrix;
  Eigen::VectorXd gradient;
};

using Law = void (*)(EliminatedProblem&, const Dense&, ThreadPool&, double damping);

void ForCases(Law law) {
  unsigned seed = 0;
  for (const JointKind& kind : JointKinds()) {
    for (const Loss loss : {Loss::kNone, Loss::kHuber, Loss::kTukey}) {
      for (const bool orthogonal : {false, true}) {
        SCOPED_TRACE("seed " + std::to_string(++seed) + ", " + kind.Name());
        RandomSplines random(seed);
        const JointCase c = RandomJointCase(random, kind);
        JointOptions options;
        options.orthogonal = orthogonal;
        options.loss = loss;
        options.loss_scale = 0.03;
        options.fairness = seed % 4 == 0 ? 0 : 1e-3;
        ThreadPool pool(2);
        EliminatedProblem cells(c.problem, c.net, c.weights, options, pool);
        cells.damping = seed % 3 == 0 ? 0.0 : 0.3;
        ASSERT_TRUE(cells.Project());
        cells.Accept();
        law(cells, Dense(cells), pool, cells.damping);
      }
    }
  }
}

// The step solves the normal equations of the cells' rows, but for a ridge of 1e-8 of the diagonal,
// or more where they are singular; and the fall that it promises is that of their model.
TEST(GaussNewtonSystemTest, SolvesTheNormalEquationsOfTheCellsRows) {
  ForCases([](EliminatedProblem& cells, const Dense& dense, ThreadPool& pool, double damping) {
    GaussNewtonSystem system(
        cells, std::vector<bool>(static_cast<size_t>(cells.blocks()), false), pool);
    system.Refresh();
    const double scale = dense.gradient.cwiseAbs().maxCoeff();
    EXPECT_NEAR(system.steepness(), scale, kIterated * scale);
    const std::optional<GaussNewtonSystem::Step> step = system.Solve(damping);
    ASSERT_TRUE(step);
    const Eigen::VectorXd s = step->net.reshaped();
    const double diagonal = dense.matrix.diagonal().maxCoeff();
    EXPECT_LE((dense.matrix * s + dense.gradient).norm(),
              1e-6 * (diagonal * s.norm() + dense.gradient.norm()));
    const double fall = -dense.gradient.dot(s) - s.dot(dense.matrix * s) / 2;
    EXPECT_NEAR(step->promise, fall, 1e-6 * std::abs(fall));
    EXPECT_GT(fall, 0);
  });
}

TEST(GaussNewtonSystemTest, LeavesFixedBlocksWhereTheyAre) {
  ForCases([](EliminatedProblem& cells, const Dense& dense, ThreadPool& pool, double) {
    std::vector<bool> fixed(static_cast<size_t>(cells.blocks()), false);
    for (size_t k = 0; k < fixed.size(); k += 3) fixed[k] = true;
    GaussNewtonSystem system(cells, fixed, pool);
    system.Refresh();
    const std::optional<GaussNewtonSystem::Step> step = system.Solve(0.5);
    ASSERT_TRUE(step);
    const int dim = cells.dimension();
    double steepest = 0;
    for (size_t k = 0; k < fixed.size(); ++k) {
      const auto block = static_cast<Eigen::Index>(k);
      if (fixed[k]) {
        EXPECT_EQ(step->net.col(block), Eigen::VectorXd::Zero(dim));
      } else {
        steepest =
            std::max(steepest, dense.gradient.segment(dim * block, dim).cwiseAbs().maxCoeff());
      }
    }
    EXPECT_NEAR(system.steepness(), steepest, kIterated * steepest);
    EXPECT_GT(step->promise, 0);
  });
}

TEST(GaussNewtonSystemTest, GivesTheSameBitsForEveryNumberOfThreads) {
  for (const JointKind& kind : JointKinds()) {
    SCOPED_TRACE(kind.Name());
    RandomSplines random(3);
    const JointCase c = RandomJointCase(random, kind);
    const JointOptions options;
    std::vector<Eigen::MatrixXd> nets;
    for (const int threads : {1, 2, 3}) {
      ThreadPool pool(threads);
      EliminatedProblem cells(c.problem, c.net, c.weights, options, pool);
      ASSERT_TRUE(cells.Project());
      cells.AcceptState();
      GaussNewtonSystem system(
          cells, std::vector<bool>(static_cast<size_t>(cells.blocks()), false), pool);
      system.Refresh();
      const std::optional<GaussNewtonSystem::Step> step = system.Solve(0.01);
      ASSERT_TRUE(step);
      nets.push_back(step->net);
    }
    EXPECT_EQ(nets[0], nets[1]);
    EXPECT_EQ(nets[0], nets[2]);
  }
}

}  // namespace batten::internal::gauss_newton_system_test
