// SPDX-License-Identifier: MIT
#include "batten/fitting/robust_loss.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <string>

#include "random_splines.h"
#include "tolerances.h"

namespace batten::internal::robust_loss_test {

constexpr std::array kLosses{
    Loss::kNone, Loss::kHuber, Loss::kCauchy, Loss::kTukey, Loss::kTruncated};
constexpr std::array kBounding{Loss::kHuber, Loss::kCauchy, Loss::kTukey, Loss::kTruncated};

// Where Huber's turns linear and Tukey's constant.
constexpr double kKnees[]{1.345, 2.385, 4.685};

constexpr double kTruncation = 2.795;

std::string Trace(Loss loss) { return "loss " + std::to_string(static_cast<int>(loss)); }

Eigen::VectorXd NormalSample(unsigned seed, Eigen::Index count, double sigma) {
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> normal(0, sigma);
  Eigen::VectorXd sample(count);
  for (double& x : sample) x = normal(engine);
  return sample;
}

TEST(LossTest, HasTheWeightThatItsSlopeOverTheResidualSays) {
  for (const Loss loss : kLosses) {
    SCOPED_TRACE(Trace(loss));
    RandomSplines random(1);
    for (int trial = 0; trial < 200; ++trial) {
      const double scale = random.Logarithmic(1e-3, 1e3);
      const double r = scale * random.Logarithmic(1e-2, 30), h = kHalfDigits * r;
      if (loss == Loss::kTruncated && std::abs(r / scale - kTruncation) < 1e-3) continue;  // a kink
      const double slope =
          (LossValue(loss, r + h, scale) - LossValue(loss, r - h, scale)) / (2 * h);
      // A difference of values loses their digits relative to the step.
      const double digits = kHalfDigits * std::max(1.0, LossValue(loss, r, scale) / (r * r));
      EXPECT_NEAR(LossWeight(loss, r, scale), slope / r, digits)
          << "r = " << r << ", scale " << scale;
    }
  }
}

TEST(LossTest, IsContinuousAtItsKnees) {
  for (const Loss loss : kLosses) {
    SCOPED_TRACE(Trace(loss));
    for (const double knee : kKnees) {
      const double below = std::nextafter(knee, 0), above = std::nextafter(knee, 9);
      EXPECT_NEAR(LossValue(loss, below, 1), LossValue(loss, above, 1), kRounding);
      EXPECT_NEAR(LossWeight(loss, below, 1), LossWeight(loss, above, 1), kRounding);
    }
    EXPECT_NEAR(LossValue(loss, std::nextafter(kTruncation, 0), 1),
                LossValue(loss, std::nextafter(kTruncation, 9), 1),
                kRounding);
  }
}

TEST(LossTest, IsThePlainSquareNearZero) {
  for (const Loss loss : kLosses) {
    SCOPED_TRACE(Trace(loss));
    EXPECT_EQ(LossValue(loss, 0, 1), 0);
    EXPECT_EQ(LossWeight(loss, 0, 1), 1);
    const double r = 1e-5;  // the losses part from the square by r⁴
    EXPECT_NEAR(LossValue(loss, r, 1), r * r / 2, kHalfDigits * r * r);
    EXPECT_NEAR(LossWeight(loss, r, 1), 1, kHalfDigits);
  }
}

TEST(LossTest, BoundsThePullOfFarPoints) {
  for (const Loss loss : kBounding) {
    SCOPED_TRACE(Trace(loss));
    for (const double r : {1e6, 1e150, 1e300}) {
      EXPECT_LE(LossWeight(loss, r, 1) * r, 2.5) << "r = " << r;
      EXPECT_TRUE(std::isfinite(LossWeight(loss, r, 1)));
    }
    EXPECT_EQ(LossWeight(loss, std::numeric_limits<double>::infinity(), 1), 0);
  }
  EXPECT_EQ(LossWeight(Loss::kNone, 1e300, 1), 1);
}

TEST(LossTest, OfTukeyIsConstantBeyondItsKnee) {
  const double limit = 4.685 * 4.685 / 6;
  for (const double r : {4.685, 5.0, 1e9}) {
    EXPECT_NEAR(LossValue(Loss::kTukey, r, 1), limit, kRounding * limit);
    EXPECT_NEAR(LossWeight(Loss::kTukey, r, 1), 0, kRounding);
  }
}

TEST(LossTest, OfTheTruncatedSquareIsAllOrNothing) {
  for (const double scale : {1e-6, 1.0, 1e6}) {
    const double knee = kTruncation * scale;
    EXPECT_EQ(LossWeight(Loss::kTruncated, 0.999 * knee, scale), 1);
    EXPECT_EQ(LossWeight(Loss::kTruncated, 1.001 * knee, scale), 0);
    EXPECT_NEAR(
        LossValue(Loss::kTruncated, 50 * knee, scale), knee * knee / 2, kRounding * knee * knee);
  }
}

TEST(LossTest, ForgetsFarPointsWhereTheirWeightIsZero) {
  for (const Loss loss : kLosses) {
    SCOPED_TRACE(Trace(loss));
    EXPECT_EQ(ForgetsFarPoints(loss), LossWeight(loss, 1e3, 1) == 0);
  }
}

TEST(LossTest, DoesNotAskForTheSignOfTheResidual) {
  for (const Loss loss : kLosses) {
    SCOPED_TRACE(Trace(loss));
    for (double r = 0.1; r < 20; r *= 1.3) {
      EXPECT_EQ(LossValue(loss, -r, 0.7), LossValue(loss, r, 0.7));
      EXPECT_EQ(LossWeight(loss, -r, 0.7), LossWeight(loss, r, 0.7));
    }
  }
}

TEST(LossTest, ScalesWithTheUnit) {
  for (const Loss loss : kLosses) {
    SCOPED_TRACE(Trace(loss));
    for (const double unit : {1e-6, 0.3, 25.4, 1e6}) {
      for (double r = 0.1; r < 20; r *= 1.3) {
        const double value = LossValue(loss, r, 0.7);
        EXPECT_NEAR(LossValue(loss, unit * r, unit * 0.7),
                    unit * unit * value,
                    kRounding * unit * unit * value);
        EXPECT_NEAR(LossWeight(loss, unit * r, unit * 0.7), LossWeight(loss, r, 0.7), kRounding);
      }
    }
  }
}

TEST(LossTest, NeverFallsAsTheResidualGrowsAndItsWeightNeverRises) {
  for (const Loss loss : kLosses) {
    SCOPED_TRACE(Trace(loss));
    double value = 0, weight = 1;
    for (double r = 0; r < 20; r += 0.01) {
      EXPECT_GE(LossValue(loss, r, 1), value);
      EXPECT_LE(LossWeight(loss, r, 1), weight);
      value = LossValue(loss, r, 1);
      weight = LossWeight(loss, r, 1);
    }
  }
}

TEST(LossTest, LeavesExactDataAlone) {
  const Eigen::Vector3d residuals(0, 1, -2);
  for (const Loss loss : kLosses) {
    SCOPED_TRACE(Trace(loss));
    EXPECT_EQ(LossWeights(loss, residuals, 0), Eigen::Vector3d::Ones());
    for (const double r : residuals) {
      EXPECT_EQ(LossValue(loss, r, 0), r * r / 2);
      EXPECT_EQ(LossWeight(loss, r, 0), 1);
    }
  }
}

TEST(LossTest, KeepsNinetyFivePercentEfficiencyOnNormalNoise) {
  // The variance of a location by the loss is E[ψ²] / E[ψ']², that of the mean 1; ψ = w·r. By the
  // trapezium rule over the normal density, ψ' by differences.
  for (const Loss loss : kBounding) {
    SCOPED_TRACE(Trace(loss));
    const auto psi = [&](double r) { return LossWeight(loss, r, 1) * r; };
    double squares = 0, slopes = 0;
    for (double r = -10; r < 10; r += 1e-3) {
      const double density = std::exp(-r * r / 2) / std::sqrt(2 * 3.14159265358979323846) * 1e-3;
      squares += density * psi(r) * psi(r);
      slopes +=
          density * (psi(r + 5e-4) - psi(r - 5e-4)) / 1e-3;  // as wide as the step: no jump is lost
    }
    EXPECT_NEAR(slopes * slopes / squares, 0.95, 0.001);
  }
}

TEST(LossWeightsTest, AreTheWeightsOfTheResidualsOneByOne) {
  RandomSplines random(2);
  Eigen::VectorXd residuals(50);
  for (double& r : residuals) r = random.Real(-10, 10);
  for (const Loss loss : kLosses) {
    const Eigen::VectorXd weights = LossWeights(loss, residuals, 0.8);
    for (Eigen::Index k = 0; k < 50; ++k)
      EXPECT_EQ(weights[k], LossWeight(loss, residuals[k], 0.8));
  }
}

TEST(RobustScaleTest, IsTheStandardDeviationOfNormalNoise) {
  for (unsigned seed = 0; seed < 5; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    for (const double sigma : {1e-6, 1.0, 1e6}) {
      // The median absolute deviation of 20 000 sequence_outliers by 0.8 % (1.17 / sqrt(m)); four
      // times that.
      EXPECT_NEAR(RobustScale(NormalSample(seed, 20000, sigma)), sigma, 0.033 * sigma);
    }
  }
}

TEST(RobustScaleTest, IsHardlyMovedByGrossErrors) {
  Eigen::VectorXd residuals = NormalSample(6, 20000, 1);
  const double before = RobustScale(residuals);
  residuals.head(2000).setConstant(1e9);
  // The median of the rest moves to the quantile 0.5 / 0.9 of |r|: 0.765 σ in place of 0.674 σ.
  EXPECT_NEAR(RobustScale(residuals) / before, 0.765 / 0.6745, 0.05);
}

TEST(RobustScaleTest, OfExactDataIsZero) { EXPECT_EQ(RobustScale(Eigen::VectorXd::Zero(9)), 0); }

}  // namespace batten::internal::robust_loss_test
