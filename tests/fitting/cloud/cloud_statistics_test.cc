// SPDX-License-Identifier: MIT
#include "batten/fitting/cloud_statistics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "random_splines.h"

namespace batten::internal::cloud_statistics_test {

// What the estimates promise on clean random sheets; 3000 samples stray by far less.
constexpr double kSpacingShare = 0.10, kNoiseShare = 0.15;

class Noise {
 public:
  explicit Noise(unsigned seed) : engine_(seed) {}
  double Normal() { return normal_(engine_); }
  Eigen::Vector3d Vector() { return {Normal(), Normal(), Normal()}; }
  double Real(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(engine_);
  }

 private:
  std::mt19937_64 engine_;
  std::normal_distribution<double> normal_;
};

struct Shape {
  std::string name;
  double area;
  std::function<Eigen::Vector3d(Noise&)> point;  // evenly by area
};

std::vector<Shape> Shapes() {
  return {{"plane", 2, [](Noise& n) { return Eigen::Vector3d(n.Real(0, 2), n.Real(0, 1), 0); }},
          {"sphere", 4 * 3.14159265358979, [](Noise& n) { return n.Vector().normalized().eval(); }},
          // Slopes up to 0.12: the area is that of the plan to 1 %.
          {"wavy sheet", 4, [](Noise& n) {
             const double x = n.Real(0, 2), y = n.Real(0, 2);
             return Eigen::Vector3d(x, y, 0.02 * std::sin(4 * x) * std::cos(3 * y));
           }}};
}

Eigen::Matrix3Xd Sample(const Shape& shape, Eigen::Index count, double sigma, unsigned seed) {
  Noise noise(seed);
  Eigen::Matrix3Xd points(3, count);
  for (Eigen::Index k = 0; k < count; ++k)
    points.col(k) = shape.point(noise) + sigma * noise.Vector();
  return points;
}

CloudStatistics Measure(const Eigen::Matrix3Xd& points,
                        const CloudStatisticsOptions& options = {},
                        int threads = 1) {
  ThreadPool pool(threads);
  return MeasureCloud(points, NeighbourIndex(points), options, pool);
}

const CloudStatisticsOptions kNoOutliers{.find_outliers = false};

TEST(MeasureCloudTest, FindsTheSpacingThatTheDensitySays) {
  for (const Shape& shape : Shapes()) {
    for (const Eigen::Index count : {2000, 20000}) {
      SCOPED_TRACE(shape.name + ", " + std::to_string(count) + " points");
      const double expected = std::sqrt(shape.area / static_cast<double>(count));
      EXPECT_NEAR(Measure(Sample(shape, count, 0, 1), kNoOutliers).spacing,
                  expected,
                  kSpacingShare * expected);
    }
  }
}

TEST(MeasureCloudTest, IsNotMisledByNearDuplicates) {
  const Shape sheet = Shapes().front();
  Eigen::Matrix3Xd points = Sample(sheet, 10000, 0, 2);
  for (Eigen::Index k = 1; k < points.cols(); k += 2) {
    points.col(k) = points.col(k - 1) + Eigen::Vector3d(1e-9, 0, 0);
  }
  // Twice in every place: the count per area stays, the nearest neighbour is nearly at zero.
  const double expected = std::sqrt(sheet.area / 10000);
  EXPECT_NEAR(Measure(points, kNoOutliers).spacing, expected, kSpacingShare * expected);
}

TEST(MeasureCloudTest, RecoversTheNoiseAtEveryScale) {
  for (const Shape& shape : Shapes()) {
    // Much less than the spacing of 0.01 to 0.03, and a good part of it.
    for (const double sigma : {0.0005, 0.002}) {
      for (const double scale : {1e-6, 1.0, 1e6}) {
        SCOPED_TRACE(shape.name + ", sigma " + std::to_string(sigma) + ", scale " +
                     std::to_string(scale));
        const Eigen::Matrix3Xd points = scale * Sample(shape, 20000, sigma, 3);
        EXPECT_NEAR(Measure(points, kNoOutliers).noise / scale, sigma, kNoiseShare * sigma);
      }
    }
  }
}

TEST(MeasureCloudTest, RecoversTheNoiseThatIsAsLargeAsTheSpacing) {
  for (const Shape& shape : Shapes()) {
    for (const double ratio : {0.5, 1.0, 2.0}) {
      SCOPED_TRACE(shape.name + ", ratio " + std::to_string(ratio));
      const double spacing = std::sqrt(shape.area / 20000);
      const CloudStatistics measured =
          Measure(Sample(shape, 20000, ratio * spacing, 3), kNoOutliers);
      EXPECT_NEAR(measured.noise, ratio * spacing, 0.1 * ratio * spacing);
      EXPECT_NEAR(measured.spacing, spacing, kSpacingShare * spacing);
    }
  }
}

TEST(MeasureCloudTest, ScalesWithTheCloud) {
  const Shape shape = Shapes().back();
  const Eigen::Matrix3Xd points = Sample(shape, 5000, 0.002, 4);
  const CloudStatistics one = Measure(points, kNoOutliers);
  for (const double unit : {0x1p-20, 0x1p20}) {
    // A power of two changes no digit, so not even the float neighbours differ.
    const CloudStatistics other = Measure(unit * points, kNoOutliers);
    EXPECT_DOUBLE_EQ(other.spacing, unit * one.spacing);
    EXPECT_DOUBLE_EQ(other.noise, unit * one.noise);
  }
}

TEST(MeasureCloudTest, FlagsTheSamePointsAtEveryScale) {
  const Shape shape = Shapes().back();
  Eigen::Matrix3Xd points = Sample(shape, 3000, 0.002, 4);
  Noise noise(4);
  for (Eigen::Index k = 0; k < 60; ++k) points(2, k) += noise.Real(0.5, 3);
  const CloudStatistics one = Measure(points);
  EXPECT_GE(one.outlier_count, 57);
  for (const double unit : {0x1p-20, 0x1p20}) {
    EXPECT_TRUE((Measure(unit * points).outliers == one.outliers).all()) << "unit " << unit;
  }
}

TEST(MeasureCloudTest, DoesNotCareWhereTheCloudLies) {
  const Shape shape = Shapes().front();
  const Eigen::Matrix3Xd points = Sample(shape, 5000, 0.002, 5);
  const CloudStatistics here = Measure(points, kNoOutliers);
  const CloudStatistics there =
      Measure(points.colwise() + Eigen::Vector3d(5e5, 5.4e6, 300), kNoOutliers);
  // Coordinates of 5e6 are 1e-9 apart, a two millionth of the noise; float neighbours differ here
  // and there.
  constexpr double kOtherNeighbours = 1e-3;
  EXPECT_NEAR(there.spacing, here.spacing, kOtherNeighbours * here.spacing);
  EXPECT_NEAR(there.noise, here.noise, kOtherNeighbours * here.noise);
}

TEST(MeasureCloudTest, FlagsGrossErrorsAndHardlyAnyGoodPoint) {
  for (const Shape& shape : Shapes()) {
    for (unsigned seed = 0; seed < 3; ++seed) {
      SCOPED_TRACE(shape.name + ", seed " + std::to_string(seed));
      constexpr Eigen::Index kCount = 10000, kBad = 500;
      Eigen::Matrix3Xd points = Sample(shape, kCount, 0.002, seed);
      Noise noise(100 + seed);
      for (Eigen::Index k = 0; k < kBad; ++k) {
        // Ten to fifty spacings off, on either side: gross, whatever the spacing of 0.014 to 0.035.
        const double off = noise.Real(0.35, 0.7) * (noise.Real(0, 1) < 0.5 ? -1 : 1);
        const Eigen::Vector3d normal = shape.name == "sphere" ? points.col(k).normalized().eval()
                                                              : Eigen::Vector3d::UnitZ().eval();
        points.col(k) += off * normal;
      }
      const CloudStatistics statistics = Measure(points);
      EXPECT_EQ(statistics.outlier_count, statistics.outliers.count());
      EXPECT_GE(statistics.outliers.head(kBad).count(), kBad * 95 / 100);
      EXPECT_LT(statistics.outliers.tail(kCount - kBad).count(), (kCount - kBad) / 200);
    }
  }
}

TEST(MeasureCloudTest, FlagsPointsScatteredThroughSpaceThoughTheyKeepEachOtherCompany) {
  for (const Shape& shape : Shapes()) {
    for (const double share : {0.01, 0.05, 0.2}) {
      SCOPED_TRACE(shape.name + ", share " + std::to_string(share));
      constexpr Eigen::Index kCount = 10000;
      Eigen::Matrix3Xd points = Sample(shape, kCount, 0.002, 11);
      const auto bad = static_cast<Eigen::Index>(share * kCount);
      Noise noise(12);
      for (Eigen::Index k = 0; k < bad; ++k) {
        double off;  // at least a quarter, ten spacings, from every shape
        do {
          points.col(k) << noise.Real(-2, 2), noise.Real(-2, 2), noise.Real(-2, 2);
          off = shape.name == "sphere" ? points.col(k).norm() - 1 : points(2, k);
        } while (std::abs(off) < 0.25);
      }
      const PointMask outliers = Measure(points).outliers;
      EXPECT_GE(outliers.head(bad).count(), bad * 95 / 100);
      EXPECT_LT(outliers.tail(kCount - bad).count(), kCount / 200);
    }
  }
}

TEST(MeasureCloudTest, KeepsASurfaceThatIsSampledVeryUnevenly) {
  // From far below the usual spacing of 0.01 or so to twice that.
  for (const double sigma : {0.0, 0.002, 0.02}) {
    SCOPED_TRACE("sigma " + std::to_string(sigma));
    Noise noise(13);
    Eigen::Matrix3Xd points(3, 10000);
    for (auto p : points.colwise()) {
      const double x = 2 * std::pow(noise.Real(0, 1), 3), y = noise.Real(0, 2);
      p << x, y, 0.3 * std::sin(3 * x) * std::cos(2 * y) + sigma * noise.Normal();
    }
    EXPECT_LT(Measure(points).outlier_count, 50);
  }
}

TEST(MeasureCloudTest, FlagsHardlyAnyPointWhereAllAreGood) {
  for (const Shape& shape : Shapes()) {
    for (const double sigma : {0.0, 0.002, 0.02}) {
      SCOPED_TRACE(shape.name + ", sigma " + std::to_string(sigma));
      EXPECT_LT(Measure(Sample(shape, 10000, sigma, 6)).outlier_count, 50);
    }
  }
}

TEST(MeasureCloudTest, DoesNotDependOnTheNumberOfThreads) {
  Eigen::Matrix3Xd points = Sample(Shapes().back(), 3000, 0.002, 7);
  points.row(2).head(30).array() += 1;
  const CloudStatistics one = Measure(points, {}, 1);
  for (const int threads : {2, 3}) {
    const CloudStatistics more = Measure(points, {}, threads);
    EXPECT_EQ(more.spacing, one.spacing);
    EXPECT_EQ(more.noise, one.noise);
    EXPECT_TRUE((more.outliers == one.outliers).all());
  }
}

TEST(MeasureCloudTest, TakesCloudsOfFewPoints) {
  for (const Eigen::Index count : {0, 1, 2, 3, 19, 20, 59, 60}) {
    SCOPED_TRACE(std::to_string(count) + " points");
    const Eigen::Matrix3Xd points = Sample(Shapes().front(), count, 0.01, 8);
    ThreadPool pool(1);
    // An index needs a point; the cloud may still have none.
    const NeighbourIndex index(count > 0 ? points : Eigen::Matrix3Xd::Zero(3, 1));
    const CloudStatistics statistics = MeasureCloud(points, index, {}, pool);
    EXPECT_EQ(statistics.outliers.size(), count);
    EXPECT_TRUE(std::isfinite(statistics.spacing));
    EXPECT_TRUE(std::isfinite(statistics.noise));
    EXPECT_EQ(statistics.spacing > 0, count >= 2);
    if (count < 20) {
      EXPECT_EQ(statistics.noise, 0);
      EXPECT_EQ(statistics.outlier_count, 0);
    }
  }
}

TEST(MeasureCloudTest, FlagsNothingWhenToldNotToLook) {
  Eigen::Matrix3Xd points = Sample(Shapes().front(), 1000, 0, 9);
  points(2, 0) = 5;
  EXPECT_EQ(Measure(points, kNoOutliers).outlier_count, 0);
  EXPECT_FALSE(Measure(points, kNoOutliers).outliers.any());
  EXPECT_TRUE(Measure(points).outliers[0]);
}

TEST(MeasureCloudTest, StopsWhenProgressAsksItTo) {
  const Eigen::Matrix3Xd points = Sample(Shapes().front(), 1000, 0, 10);
  ThreadPool pool(1);
  EXPECT_THROW(
      MeasureCloud(
          points, NeighbourIndex(points), {}, pool, [](const char*, double) { return false; }),
      Cancelled);
}

TEST(SampleIndicesTest, AreDifferentAndInOrderAndInRange) {
  for (unsigned seed = 0; seed < 100; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const int size = random.Integer(0, 1000), count = random.Integer(0, 1200);
    const std::vector<Eigen::Index> indices = SampleIndices(size, count, seed);
    ASSERT_EQ(std::ssize(indices), std::min(size, count));
    Eigen::Index previous = -1;
    for (const Eigen::Index index : indices) {
      EXPECT_GT(index, previous);
      previous = index;
    }
    EXPECT_LT(previous, size);
  }
}

TEST(SampleIndicesTest, AreThoseOfTheSeed) {
  EXPECT_EQ(SampleIndices(10000, 100, 5), SampleIndices(10000, 100, 5));
  EXPECT_NE(SampleIndices(10000, 100, 5), SampleIndices(10000, 100, 6));
}

// A scanner's lines, ten times as far apart as the points along them: the nearest neighbours of a
// point are on its own line, through which any plane goes.
TEST(MeasureCloudTest, MeasuresTheNoiseOfScanLines) {
  constexpr double kNoise = 2e-4;
  for (const double far : {1.0, 4.0, 5.0, 6.25, 8.0, 10.0, 13.4, 14.0, 20.0, 40.0}) {
    SCOPED_TRACE("lines apart " + std::to_string(far));
    Noise noise(11);
    const double along = 0.002, across = far * along;
    const auto lines = static_cast<Eigen::Index>(40);
    Eigen::Matrix3Xd points(3, lines * 500);
    for (Eigen::Index k = 0; k < points.cols(); ++k) {
      const double x = along * static_cast<double>(k % 500) + 1e-6 * noise.Normal(),
                   y = across * static_cast<double>(k / 500) + 1e-6 * noise.Normal();
      points.col(k) << x, y, 0.05 * std::sin(3 * x) * std::cos(2 * y) + kNoise * noise.Normal();
    }
    const CloudStatistics found = Measure(points);
    EXPECT_NEAR(found.noise, kNoise, kNoiseShare * kNoise);
    EXPECT_LE(found.outlier_count, points.cols() / 200);
  }
}

}  // namespace batten::internal::cloud_statistics_test
