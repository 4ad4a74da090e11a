// SPDX-License-Identifier: MIT
#include "batten/fitting/cloud_statistics.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include "batten/fitting/statistics.h"
#include "fitting/cloud/cloud_outliers.h"
#include "fitting/core/rules.h"
#include "fitting/neighbours/local_quadric.h"
#include "geometry/numeric/dense_solvers.h"

namespace batten {
using namespace internal;
namespace {

constexpr int kFewPoints = 20;
constexpr int kNarrowBall = 14, kWideBall = 30, kWidestBall = 480;  // points
constexpr double kClearlyLess = 0.7;
constexpr double kOnALine = 0.2;    // breadth over length: such balls see one scan line
constexpr double kNearlyAll = 0.1;  // share of the balls that may be as narrow
constexpr double kThick = 0.2;      // deviation over radius; above, larger balls are used

// Median distance of numbers from their median.
double MedianDeviation(std::vector<double> numbers) {
  const double middle = Median(numbers);
  for (double& one : numbers) one = std::abs(one - middle);
  return Median(std::move(numbers));
}

// Ratio of the points' breadth to their length, all of them or most. A dozen on one line and a
// point or two of the next are as broad as long; their quadric explains the noise of the dozen.
double BreadthOf(const Eigen::Matrix3Xd& local) {
  const Eigen::Matrix3Xd centred = local.colwise() - Eigen::Vector3d(local.rowwise().mean());
  const SymmetricEigen3 solver = QuickEigenOf3(centred * centred.transpose());
  const Eigen::Vector3d spread = solver.values.cwiseMax(0.0);
  if (!(spread[2] > 0)) return 0;
  const auto along = [&](int axis) {
    const Eigen::VectorXd places = centred.transpose() * solver.vectors.col(axis);
    return MedianDeviation({places.begin(), places.end()});
  };
  const double length = along(2), of_all = std::sqrt(spread[1] / spread[2]);
  return length > 0 ? std::min(of_all, along(1) / length) : of_all;
}

// Medians over the samples: deviations from the quadrics through k neighbours each, the radii of
// the balls these lie in, and the breadth of nearly all.
struct BallNoise {
  double deviation = 0, radius = 0, breadth = 0;

  double Thickness() const { return radius > 0 ? deviation / radius : 0; }
  // A ball holds only the middle of a cloud that is thick for it. The factor that gives the
  // standard deviation was measured on planes with normal noise and any number of neighbours; good
  // to 3 % where the thickness is below kMostThickness.
  double Corrected() const {
    const double x2 = std::pow(std::min(Thickness(), kMostThickness), 2);
    return deviation * (1 + 1.6 * x2 + 170 * x2 * x2 * x2);
  }

  static constexpr double kMostThickness = 0.29;
};

BallNoise NoiseAt(const Eigen::Matrix3Xd& points,
                  const NeighbourIndex& index,
                  const std::vector<Eigen::Index>& samples,
                  int k,
                  ThreadPool& pool) {
  std::vector<double> deviations(samples.size()), radii(samples.size()), breadths(samples.size());
  pool.For(static_cast<std::ptrdiff_t>(samples.size()), 64, [&](auto begin, auto end) {
    const std::span some(samples.begin() + begin, samples.begin() + end);
    const std::vector<int> near = index.Nearest(points(Eigen::all, some), k);
    for (auto i = begin; i < end; ++i) {
      const std::span around(near.begin() + (i - begin) * k, static_cast<size_t>(k));
      const Eigen::Matrix3Xd local = points(Eigen::all, around).colwise() - points.col(samples[i]);
      deviations[i] = LocalQuadric(local).deviation();
      radii[i] = local.col(k - 1).norm();
      breadths[i] = BreadthOf(local);
    }
  });
  return {Median(std::move(deviations)),
          Median(std::move(radii)),
          Quantile(std::move(breadths), kNearlyAll)};
}

double MeasureNoise(const Eigen::Matrix3Xd& points,
                    const NeighbourIndex& index,
                    const CloudStatisticsOptions& options,
                    ThreadPool& pool) {
  const Eigen::Index m = points.cols();
  const auto noise_at = [&](int k) {
    const Eigen::Index count = std::max<Eigen::Index>(300, options.samples * Eigen::Index{30} / k);
    return NoiseAt(points,
                   index,
                   SampleIndices(m, std::min<Eigen::Index>(count, options.samples), options.seed),
                   k,
                   pool);
  };
  int ball = kNarrowBall;
  BallNoise narrow = noise_at(ball);
  // Along one line any plane serves: balls must reach over several, and have more than a point or
  // two of the next one.
  const auto may_grow = [&] { return 2 * ball <= kWidestBall && 2 * ball < m / 10; };
  bool on_lines = false;
  for (; narrow.breadth < kOnALine && may_grow(); on_lines = true) narrow = noise_at(ball *= 2);
  if (on_lines && may_grow()) narrow = noise_at(ball *= 2);
  if (m < 2 * kWideBall) return narrow.deviation;
  const int wider_ball = ball == kNarrowBall ? kWideBall : 2 * ball;
  BallNoise wide = noise_at(wider_ball);
  // If a smaller neighbourhood deviates clearly less, the larger one measured shape, not noise.
  if (narrow.deviation < kClearlyLess * wide.deviation) return narrow.deviation;
  for (int k = 2 * wider_ball; wide.Thickness() > kThick && k <= kWidestBall && k < m / 10;
       k *= 2) {
    const BallNoise wider = noise_at(k);
    if (wide.Thickness() < BallNoise::kMostThickness &&
        wide.Corrected() < kClearlyLess * wider.Corrected()) {
      break;
    }
    wide = wider;
  }
  return wide.Corrected();
}

}  // namespace

CloudStatistics MeasureCloud(const Eigen::Matrix3Xd& points,
                             const NeighbourIndex& index,
                             const CloudStatisticsOptions& options,
                             ThreadPool& pool,
                             const Progress& progress) {
  const Eigen::Index m = points.cols();
  CloudStatistics result;
  result.outliers = PointMask::Constant(m, false);
  if (m < 2) return result;
  const std::vector<Eigen::Index> samples = SampleIndices(m, options.samples, options.seed);

  // N points a disc of radius r: the area a point owns is πr²/N, and spacing its root.
  const int around =
      static_cast<int>(std::min<Eigen::Index>(std::clamp<Eigen::Index>(m / 4, 3, 16), m - 1));
  std::vector<double> radii(samples.size());
  pool.For(static_cast<std::ptrdiff_t>(samples.size()), 64, [&](auto begin, auto end) {
    const std::span some(samples.begin() + begin, samples.begin() + end);
    const std::vector<int> near = index.Nearest(points(Eigen::all, some), around + 1);
    for (auto i = begin; i < end; ++i) {
      const int farthest = near[(i - begin) * (around + 1) + around];
      radii[i] = (points.col(farthest) - points.col(samples[i])).norm();
    }
  });
  const double radius = Median(std::move(radii));
  result.spacing = radius * std::sqrt(std::numbers::pi / around);
  if (m < kFewPoints) return result;
  Report(progress, "prepare", 0.1);

  result.noise = MeasureNoise(points, index, options, pool);
  // A thick cloud's points are farther apart than their places on the surface: measured as above.
  const double thickness = radius > 0 ? result.noise / radius : 0;
  result.spacing /= std::sqrt(1 + 2.1 * thickness * thickness);
  Report(progress, "prepare", 0.3);
  if (!options.find_outliers || !Acts(Rule::kLocalOutliers)) return result;

  result.outliers = FindOutliers(points, index, result.spacing, result.noise, pool, progress);
  result.outlier_count = result.outliers.count();
  return result;
}

}  // namespace batten
