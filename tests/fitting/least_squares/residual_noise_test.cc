// SPDX-License-Identifier: MIT
#include "fitting/least_squares/residual_noise.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>

#include "random_splines.h"
#include "tolerances.h"

namespace batten::internal::residual_noise_test {

class NoisySheet {
 public:
  NoisySheet(unsigned seed, bool curve, Eigen::Index count) : random_(seed), engine_(seed) {
    parameters_.setZero(2, count);
    for (auto uv : parameters_.colwise()) {
      uv[0] = random_.Real(-2, 5);
      if (!curve) uv[1] = random_.Real(0, 1);
    }
  }

  const Eigen::Matrix2Xd& parameters() const { return parameters_; }

  Eigen::MatrixXd Noise(Eigen::Index dimension, double sigma) {
    std::normal_distribution<double> normal(0, sigma);
    Eigen::MatrixXd noise(dimension, parameters_.cols());
    for (double& x : noise.reshaped()) x = normal(engine_);
    return noise;
  }

  // What a shape of the wrong form leaves: smooth over the sheet.
  Eigen::MatrixXd Bias(Eigen::Index dimension, double height) const {
    Eigen::MatrixXd bias(dimension, parameters_.cols());
    for (Eigen::Index k = 0; k < bias.cols(); ++k) {
      const double value =
          height * (1 + std::sin(2 * parameters_(0, k)) * std::cos(3 * parameters_(1, k)));
      bias.col(k).setConstant(value);
    }
    return bias;
  }

 private:
  RandomSplines random_;
  std::mt19937_64 engine_;
  Eigen::Matrix2Xd parameters_;
};

// m successive differences: the variance of their mean square is 3σ⁴/(m·d) at most, since only
// neighbours in the order share a residual [von Neumann 1941]; five of its standard deviations.
double SamplingError(Eigen::Index count, Eigen::Index dimension) {
  return 5 * std::sqrt(3.0 / static_cast<double>(count * dimension));
}

TEST(ResidualNoiseTest, FindsTheVarianceOfWhiteNoise) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const Eigen::Index count = 4000, dimension = 1 + seed % 3;
    NoisySheet sheet(seed, seed % 2 == 0, count);
    const ResidualNoise noise(sheet.parameters());
    const double expected = static_cast<double>(dimension) * 0.3 * 0.3;
    EXPECT_NEAR(noise.Variance(sheet.Noise(dimension, 0.3), {}),
                expected,
                SamplingError(count, dimension) * expected);
  }
}

// Beside the mean square of the same residuals, whose sampling error it shares.
TEST(ResidualNoiseTest, IsNearTheMeanSquareOfWhiteResiduals) {
  double squares = 0;
  for (unsigned seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const Eigen::Index count = 2500;
    NoisySheet sheet(seed, seed % 2 == 0, count);
    const Eigen::MatrixXd white = sheet.Noise(1, 0.3);
    const double mean = white.squaredNorm() / static_cast<double>(count);
    const double error = ResidualNoise(sheet.parameters()).Variance(white, {}) / mean - 1;
    EXPECT_LE(std::abs(error), 4.0 / (2 * std::sqrt(count)));
    squares += error * error;
  }
  // 40 errors: their root mean square is known to a ninth.
  EXPECT_LE(std::sqrt(squares / 40), 1.3 / (2 * std::sqrt(2500)));
}

// The next four on the curve are some 20/4000 away, and the slope of the bias is 2 heights a unit.
// On the sheet they are about 2/63 of its sides away, seven units by one, with slopes of 2 and 3
// heights: some 0.15 of a height each way, squared and halved.
TEST(ResidualNoiseTest, IsNotMovedByASmoothBias) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const bool curve = seed % 2 == 0;
    NoisySheet sheet(seed, curve, 4000);
    const ResidualNoise noise(sheet.parameters());
    const Eigen::MatrixXd white = sheet.Noise(3, 0.3);
    const double plain = noise.Variance(white, {});
    for (const double height : {0.5, 3.0}) {
      const Eigen::MatrixXd bias = sheet.Bias(3, height);
      // The second term is the correlation of bias and noise by chance.
      EXPECT_NEAR(noise.Variance(white + bias, {}),
                  plain,
                  (curve ? 1e-4 : 0.04) * 3 * height * height + 0.01 * plain);
    }
  }
}

TEST(ResidualNoiseTest, HasTheVarianceOfWeightOne) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const Eigen::Index count = 4000;
    NoisySheet sheet(seed, seed % 2 == 0, count);
    RandomSplines random(seed);
    Eigen::VectorXd weights(count);
    for (double& w : weights) w = random.Integer(0, 4) == 0 ? 0 : random.Logarithmic(0.1, 10);
    Eigen::MatrixXd residuals = sheet.Noise(3, 0.3);
    for (Eigen::Index k = 0; k < count; ++k) {
      if (weights[k] > 0) {
        residuals.col(k) /= std::sqrt(weights[k]);
      } else {
        residuals.col(k).setConstant(1e9);  // what does not count may be anything
      }
    }
    const double expected = 3 * 0.3 * 0.3;
    // A fifth of the points, and with them two fifths of the pairs, do not count.
    EXPECT_NEAR(ResidualNoise(sheet.parameters()).Variance(residuals, weights),
                expected,
                2 * SamplingError(count, 3) * expected);
  }
}

TEST(ResidualNoiseTest, TakesEqualWeightsForNone) {
  NoisySheet sheet(3, false, 500);
  const ResidualNoise noise(sheet.parameters());
  const Eigen::MatrixXd residuals = sheet.Noise(3, 1);
  EXPECT_NEAR(noise.Variance(residuals, Eigen::VectorXd::Ones(500)),
              noise.Variance(residuals, {}),
              kRounding);
  EXPECT_NEAR(noise.Variance(residuals, Eigen::VectorXd::Constant(500, 4)),
              4 * noise.Variance(residuals, {}),
              100 * kRounding);
}

TEST(ResidualNoiseTest, ScalesWithTheSquareOfTheResiduals) {
  NoisySheet sheet(4, false, 500);
  const ResidualNoise noise(sheet.parameters());
  const Eigen::MatrixXd residuals = sheet.Noise(3, 1);
  const double one = noise.Variance(residuals, {});
  for (const double unit : {1e-9, -3.0, 1e9}) {
    EXPECT_NEAR(noise.Variance(unit * residuals, {}) / (unit * unit), one, kRounding * one);
  }
}

TEST(ResidualNoiseTest, DoesNotCareInWhichUnitParametersAre) {
  NoisySheet sheet(5, false, 500);
  const Eigen::MatrixXd residuals = sheet.Noise(3, 1);
  Eigen::Matrix2Xd other = sheet.parameters();
  other.row(0) *= 1024;  // exact
  other.row(1) *= 0.125;
  EXPECT_EQ(ResidualNoise(other).Variance(residuals, {}),
            ResidualNoise(sheet.parameters()).Variance(residuals, {}));
}

TEST(ResidualNoiseTest, IsZeroWithFewerThanTwoThatCount) {
  EXPECT_EQ(ResidualNoise(Eigen::Matrix2Xd(2, 0)).Variance(Eigen::MatrixXd(3, 0), {}), 0);
  EXPECT_EQ(ResidualNoise(Eigen::Matrix2Xd::Ones(2, 1)).Variance(Eigen::MatrixXd::Ones(3, 1), {}),
            0);
  NoisySheet sheet(6, false, 10);
  Eigen::VectorXd weights = Eigen::VectorXd::Zero(10);
  const ResidualNoise noise(sheet.parameters());
  EXPECT_EQ(noise.Variance(sheet.Noise(3, 1), weights), 0);
  weights[4] = 1;
  EXPECT_EQ(noise.Variance(sheet.Noise(3, 1), weights), 0);
}

TEST(ResidualNoiseTest, IsFiniteWhereAllParametersAreTheSame) {
  const ResidualNoise noise(Eigen::Matrix2Xd::Constant(2, 50, 0.3));
  NoisySheet sheet(7, false, 50);
  const double variance = noise.Variance(sheet.Noise(3, 1), {});
  EXPECT_GT(variance, 1);
  EXPECT_LT(variance, 6);
}

}  // namespace batten::internal::residual_noise_test
