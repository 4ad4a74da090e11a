// SPDX-License-Identifier: MIT
#include "fitting/cloud/double_layer_test.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "batten/fitting/point_mask.h"
#include "fitting/neighbours/local_quadric.h"

namespace batten::internal {
namespace {

constexpr int kSamples = 600;
constexpr int kAround = 120;
constexpr double kTwoHeights = 1.6;
constexpr double kMostSkewness = 1.5;       // a fifth of the points on one of the sheets
constexpr double kLeastApart = 0.4;         // spacings; rounded coordinates keep to two heights too
constexpr double kMoreThanByChance = 0.13;  // share of the points on the side of their neighbour

// Standardised moments of residuals about their mean.
struct Shape {
  double deviation = 0, skewness = 0, kurtosis = 3;
};

Shape ShapeOf(const Eigen::ArrayXd& values) {
  const Eigen::ArrayXd centred = values - values.mean();
  const double variance = centred.square().mean();
  if (!(variance > 0)) return {};
  const double deviation = std::sqrt(variance);
  return {deviation,
          centred.cube().mean() / (variance * deviation),
          centred.square().square().mean() / (variance * variance)};
}

// Share of points that lie on the side of the point nearest to them in the plane, less the share
// expected by chance for two sheets of so many points.
double ExcessBesideTheirLike(const Eigen::Matrix3Xd& local,
                             const Eigen::Vector3d& normal,
                             const Eigen::ArrayXd& residuals) {
  const double middle = (residuals.minCoeff() + residuals.maxCoeff()) / 2;
  const Eigen::Matrix3Xd plan = local - normal * (normal.transpose() * local);
  Eigen::Index same = 0;
  for (Eigen::Index i = 0; i < plan.cols(); ++i) {
    Eigen::VectorXd squared = (plan.colwise() - plan.col(i)).colwise().squaredNorm();
    squared[i] = std::numeric_limits<double>::infinity();
    Eigen::Index nearest;
    squared.minCoeff(&nearest);
    if ((residuals[i] > middle) == (residuals[nearest] > middle)) ++same;
  }
  const auto all = static_cast<double>(plan.cols());
  const double above = static_cast<double>((residuals > middle).count()) / all;
  return static_cast<double>(same) / all - above * above - (1 - above) * (1 - above);
}

bool Layered(const Eigen::Matrix3Xd& local) {
  const LocalQuadric quadric =
      LocalQuadric::Over({local.rowwise().mean(), Eigen::Vector3d::UnitZ()}, local);
  const Eigen::ArrayXd residuals = quadric.residuals().array();
  const Shape shape = ShapeOf(residuals);
  if (shape.kurtosis - shape.skewness * shape.skewness > kTwoHeights) return false;
  if (std::abs(shape.skewness) > kMostSkewness) return false;
  const Eigen::Vector3d normal = quadric.plane().normal;
  const Eigen::Matrix3Xd plan = local - normal * (normal.transpose() * local);
  const double reach = std::sqrt(plan.colwise().squaredNorm().maxCoeff());
  const double spacing = reach * std::sqrt(std::numbers::pi / kAround);
  if (2 * quadric.radius() * shape.deviation < kLeastApart * spacing) return false;
  return ExcessBesideTheirLike(local, normal, residuals) < kMoreThanByChance;
}

}  // namespace

double DoubleLayerFraction(const Eigen::Matrix3Xd& points,
                           const NeighbourIndex& index,
                           std::uint64_t seed,
                           ThreadPool& pool) {
  if (points.cols() < 2 * kAround) return 0;
  const std::vector<Eigen::Index> samples = SampleIndices(points.cols(), kSamples, seed);
  std::vector<char> layered(samples.size());
  pool.For(std::ssize(samples), 16, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (std::ptrdiff_t i = begin; i < end; ++i) {
      const Eigen::Vector3d centre = points.col(samples[i]);
      const std::vector<int> near = index.Nearest(centre, kAround);
      layered[i] = static_cast<char>(Layered(points(Eigen::all, near).colwise() - centre));
    }
  });
  return static_cast<double>(std::count(layered.begin(), layered.end(), 1)) /
         static_cast<double>(layered.size());
}

}  // namespace batten::internal
