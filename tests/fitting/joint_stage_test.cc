// SPDX-License-Identifier: MIT
#include "batten/fitting/joint_stage.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "batten/fitting/distances.h"
#include "batten/fitting/joint_cells.h"
#include "known_clouds.h"

namespace batten {
namespace {

// A graph over the unit square with a random rational net near it.
NurbsSurface RandomSheet(std::mt19937_64& random, int degree_u, int degree_v, bool rational) {
  std::uniform_real_distribution<double> uniform(-1, 1);
  const SplineBasis bu = SplineBasis::Uniform(degree_u, degree_u + 3, 0, 1);
  const SplineBasis bv = SplineBasis::Uniform(degree_v, degree_v + 2, 0, 1);
  Eigen::Matrix3Xd net(3, bu.size() * bv.size());
  Eigen::VectorXd weights = Eigen::VectorXd::Ones(net.cols());
  for (int i = 0; i < bu.size(); ++i) {
    for (int j = 0; j < bv.size(); ++j) {
      const int k = i * bv.size() + j;
      net.col(k) << bu.Greville(i) + 0.02 * uniform(random),
          bv.Greville(j) + 0.02 * uniform(random), 0.2 * uniform(random);
      if (rational) weights[k] = std::exp(0.5 * uniform(random));
    }
  }
  return NurbsSurface(bu, bv, net, weights);
}

Eigen::Matrix2Xd Feet(const NurbsSurface& surface, const Eigen::Matrix3Xd& points) {
  ThreadPool pool(1);
  return DistancesTo(surface, points, pool).parameters;
}

// Half the sum of squares over all cells; `jacobian` asks for the rows that carry derivatives.
double Cost(const JointCells& cells, bool jacobian) {
  double cost = 0;
  std::vector<double> residual(cells.rows()),
      J(static_cast<size_t>(cells.rows()) * 3 * cells.functions());
  for (int c = 0; c < cells.cells(); ++c) {
    cells.Evaluate(c, residual.data(), jacobian ? J.data() : nullptr);
    for (const double r : residual) cost += r * r / 2;
  }
  return cost;
}

class JointCellsTest : public testing::TestWithParam<Loss> {};

TEST_P(JointCellsTest, HasTheSameCostWithAndWithoutDerivatives) {
  std::mt19937_64 random(3);
  ThreadPool pool(2);
  for (int repeat = 0; repeat < 4; ++repeat) {
    const NurbsSurface surface = RandomSheet(random, 2 + repeat % 3, 3, repeat % 2 == 1);
    const Eigen::Matrix3Xd points = Scatter(Tilted, 400, 0.1, 0.1, repeat);
    JointOptions options;
    options.loss = GetParam();
    options.loss_scale = 0.05;
    const Eigen::VectorXd weights = Eigen::VectorXd::LinSpaced(points.cols(), 0.5, 2);
    JointCells cells(surface, points, weights, Feet(surface, points), options, pool);
    ASSERT_TRUE(cells.Project());
    cells.Accept();
    const double plain = Cost(cells, false);
    EXPECT_NEAR(Cost(cells, true), plain, 1e-10 * plain);
  }
}

// Foot points move while control points do; eliminated rightly, the gradient of the whole is what
// the rows say, since at a foot point the cost does not change with its parameters.
TEST_P(JointCellsTest, HasTheGradientThatDifferencesFind) {
  std::mt19937_64 random(5);
  ThreadPool pool(1);
  for (int repeat = 0; repeat < 4; ++repeat) {
    SCOPED_TRACE(repeat);
    const NurbsSurface surface = RandomSheet(random, 3, 2 + repeat % 2, repeat % 2 == 0);
    const Eigen::Matrix3Xd points = Scatter(Tilted, 300, 0.03, 0, repeat);
    JointOptions options;
    options.loss = GetParam();
    options.loss_scale = 0.05;
    JointCells cells(surface, points, {}, Feet(surface, points), options, pool);
    cells.damping = 0;
    ASSERT_TRUE(cells.Project());
    cells.Accept();
    Eigen::VectorXd gradient = Eigen::VectorXd::Zero(3 * cells.control_points());
    std::vector<double> residual(cells.rows());
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> J(cells.rows(),
                                                                             3 * cells.functions());
    for (int c = 0; c < cells.cells(); ++c) {
      cells.Evaluate(c, residual.data(), J.data());
      const Eigen::VectorXd part =
          J.transpose() * Eigen::Map<const Eigen::VectorXd>(residual.data(), cells.rows());
      const std::vector<int> indices = cells.ControlPointsOf(c);
      for (size_t k = 0; k < indices.size(); ++k)
        gradient.segment<3>(3 * indices[k]) += part.segment<3>(3 * static_cast<Eigen::Index>(k));
    }
    const double scale = gradient.cwiseAbs().maxCoeff();
    constexpr double kStep = 1e-6;
    for (int k = 0; k < cells.control_points(); k += 3) {
      for (int d = 0; d < 3; ++d) {
        double& coordinate = cells.control_point(k)[d];
        const double middle = coordinate;
        coordinate = middle + kStep;
        ASSERT_TRUE(cells.Project());
        const double above = Cost(cells, false);
        coordinate = middle - kStep;
        ASSERT_TRUE(cells.Project());
        const double below = Cost(cells, false);
        coordinate = middle;
        // Rounding of the cost over the step, and points that pass a corner of the loss, bound what
        // differences can see.
        EXPECT_NEAR(gradient[3 * k + d], (above - below) / (2 * kStep), 2e-5 * scale + 1e-8);
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Losses,
                         JointCellsTest,
                         testing::Values(Loss::kNone, Loss::kHuber, Loss::kCauchy, Loss::kTukey));

TEST(JointStageTest, RecoversASurfaceFromExactPointsAndAWrongStart) {
  std::mt19937_64 random(9);
  ThreadPool pool(2);
  const NurbsSurface truth = RandomSheet(random, 3, 3, false);
  Eigen::Matrix3Xd points(3, 3000);
  Eigen::Matrix2Xd uv(2, points.cols());
  std::uniform_real_distribution<double> uniform(0, 1);
  for (Eigen::Index k = 0; k < points.cols(); ++k) {
    uv.col(k) << uniform(random), uniform(random);
    points.col(k) = truth.At(uv(0, k), uv(1, k));
  }
  Eigen::Matrix3Xd net = truth.control_points();
  for (Eigen::Index k = 0; k < net.cols(); ++k)
    net(2, k) += 0.02 * std::sin(7.0 * static_cast<double>(k));
  const NurbsSurface start(truth.basis_u(), truth.basis_v(), net);
  JointOptions options;
  options.fairness = 0;
  const JointResult result = OptimizeJointly(start, points, {}, Feet(start, points), options, pool);
  EXPECT_LE(result.rms_after, 0.01 * result.rms_before);
  EXPECT_GT(result.iterations, 0);
}

TEST(JointStageTest, NeverReturnsWorseThanItsStartNorATurnedNormal) {
  std::mt19937_64 random(13);
  ThreadPool pool(2);
  for (int repeat = 0; repeat < 6; ++repeat) {
    SCOPED_TRACE(repeat);
    const NurbsSurface start = RandomSheet(random, 3, 3, repeat % 2 == 1);
    const Eigen::Matrix3Xd points = Scatter(Franke, 500, 0.2, 0.2, repeat);
    JointOptions options;
    options.max_iterations = 15;
    const JointResult result =
        OptimizeJointly(start, points, {}, Feet(start, points), options, pool);
    EXPECT_LE(result.rms_after, result.rms_before);
    for (int i = 0; i <= 10; ++i) {
      for (int j = 0; j <= 10; ++j) {
        const auto before = start.NormalAt(i / 10.0, j / 10.0),
                   after = result.surface.NormalAt(i / 10.0, j / 10.0);
        if (before && after) {
          EXPECT_GT(before->dot(*after), -0.2);
        }
      }
    }
  }
}

TEST(JointStageTest, StopsAtTheNoise) {
  std::mt19937_64 random(17);
  ThreadPool pool(1);
  const NurbsSurface sheet = RandomSheet(random, 3, 3, false);
  Eigen::Matrix3Xd points(3, 2000);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::normal_distribution<double> normal(0, 1e-3);
  for (Eigen::Index k = 0; k < points.cols(); ++k) {
    points.col(k) =
        sheet.At(uniform(random), uniform(random)) + Eigen::Vector3d(0, 0, normal(random));
  }
  JointOptions options;
  options.noise = 1.05e-3;
  const JointResult result = OptimizeJointly(sheet, points, {}, Feet(sheet, points), options, pool);
  EXPECT_EQ(result.iterations, 0);
  EXPECT_EQ(result.surface, sheet);
}

TEST(JointStageTest, CanBeCancelled) {
  std::mt19937_64 random(19);
  ThreadPool pool(1);
  const NurbsSurface start = RandomSheet(random, 3, 3, false);
  const Eigen::Matrix3Xd points = Scatter(Franke, 500, 0.01, 0, 1);
  JointOptions options;
  options.progress = [](const char*, double) { return false; };
  EXPECT_TRUE(OptimizeJointly(start, points, {}, Feet(start, points), options, pool).cancelled);
}

}  // namespace
}  // namespace batten
