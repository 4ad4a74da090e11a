// SPDX-License-Identifier: MIT
#include "batten/fitting/cloud_statistics.h"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>
#include <vector>

#include "batten/fitting/statistics.h"

namespace batten {
namespace {

constexpr int kFewPoints = 20;
constexpr int kPlaneNeighbours = 24;
constexpr double kOutlierInSpacings = 2.5;
constexpr double kApart = 1.4;
constexpr int kReachNeighbour = 6;
constexpr double kLonelier = 3;
constexpr double kSparser = 2;  // than usual are points scattered through space, at least, …
constexpr double kFillsSpace = 0.15;  // … and deviate from any plane by so much of their reach

// A plane through points by its centre and unit normal, and where each point stands off it.
struct LocalPlane {
  Eigen::Vector3d centre, normal;
};

LocalPlane WeightedPlane(const Eigen::Matrix3Xd& local, const Eigen::VectorXd& weights) {
  const Eigen::Vector3d centre = local * weights / weights.sum();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (Eigen::Index k = 0; k < local.cols(); ++k) {
    const Eigen::Vector3d d = local.col(k) - centre;
    covariance += weights[k] * d * d.transpose();
  }
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(covariance);
  return {centre, solver.eigenvectors().col(0)};
}

// The plane most of the points agree on: two rounds with Cauchy weights at the median deviation.
// Returns the distance of the origin of `local` from it and the robust scale of the points' own.
std::pair<double, double> OffsetAndScale(const Eigen::Matrix3Xd& local) {
  Eigen::VectorXd weights = Eigen::VectorXd::Ones(local.cols());
  std::vector<double> deviation(static_cast<size_t>(local.cols()));
  LocalPlane plane;
  double scale = 0;
  for (int round = 0; round < 3; ++round) {
    plane = WeightedPlane(local, weights);
    const Eigen::VectorXd d = (local.colwise() - plane.centre).transpose() * plane.normal;
    for (Eigen::Index k = 0; k < d.size(); ++k) deviation[k] = std::abs(d[k]);
    auto middle = deviation.begin() + static_cast<std::ptrdiff_t>(deviation.size() / 2);
    std::nth_element(deviation.begin(), middle, deviation.end());
    scale = kMadToSigma * *middle;
    if (!(scale > 0)) break;
    weights = (1 + (d.array() / (2 * scale)).square()).inverse().matrix();
  }
  return {std::abs(plane.centre.dot(plane.normal)), scale};
}

// Residual standard deviation of the least-squares quadric z(x,y) in the frame of the local plane.
double QuadricDeviation(const Eigen::Matrix3Xd& local) {
  const LocalPlane plane = WeightedPlane(local, Eigen::VectorXd::Ones(local.cols()));
  Eigen::Vector3d axis = plane.normal.unitOrthogonal();
  Eigen::Vector3d other = plane.normal.cross(axis);
  const Eigen::Matrix3Xd centred = local.colwise() - plane.centre;
  const double radius = std::sqrt(centred.colwise().squaredNorm().maxCoeff());
  if (!(radius > 0)) return 0;
  const Eigen::ArrayXd x = (centred.transpose() * axis).array() / radius;
  const Eigen::ArrayXd y = (centred.transpose() * other).array() / radius;
  const Eigen::VectorXd z = centred.transpose() * plane.normal;
  Eigen::MatrixXd design(local.cols(), 6);
  design << Eigen::VectorXd::Ones(local.cols()), x.matrix(), y.matrix(), (x * x).matrix(),
      (x * y).matrix(), (y * y).matrix();
  const Eigen::VectorXd solution = design.colPivHouseholderQr().solve(z);
  const double freedom = static_cast<double>(local.cols() - 6);
  return std::sqrt((z - design * solution).squaredNorm() / freedom);
}

Eigen::Matrix3Xd Neighbourhood(const Eigen::Matrix3Xd& points,
                               const Eigen::Vector3d& centre,
                               const int* neighbours,
                               int count) {
  Eigen::Matrix3Xd local(3, count);
  for (int j = 0; j < count; ++j) local.col(j) = points.col(neighbours[j]) - centre;
  return local;
}

// Robust median of the quadric deviations over the samples, with k neighbours each.
double NoiseAt(const Eigen::Matrix3Xd& points,
               const NeighbourIndex& index,
               const std::vector<Eigen::Index>& samples,
               int k,
               ThreadPool& pool) {
  std::vector<double> deviations(samples.size());
  pool.For(static_cast<std::ptrdiff_t>(samples.size()), 64, [&](auto begin, auto end) {
    Eigen::Matrix3Xd queries(3, end - begin);
    for (auto i = begin; i < end; ++i) queries.col(i - begin) = points.col(samples[i]);
    const std::vector<int> near = index.Nearest(queries, k);
    for (auto i = begin; i < end; ++i) {
      deviations[i] = QuadricDeviation(
          Neighbourhood(points, points.col(samples[i]), near.data() + (i - begin) * k, k));
    }
  });
  return Median(std::move(deviations));
}

// How every point stands to its neighbours.
struct Standing {
  Eigen::VectorXd offset;  // off the plane of its neighbours
  Eigen::VectorXd scale;   // of the neighbours' own deviations from that plane
  Eigen::VectorXd reach;   // distance of its sixth neighbour
};

Standing MeasureStanding(const Eigen::Matrix3Xd& points,
                         const NeighbourIndex& index,
                         ThreadPool& pool,
                         const Progress& progress) {
  const Eigen::Index m = points.cols();
  const int k = static_cast<int>(std::min<Eigen::Index>(kPlaneNeighbours + 1, m));
  Standing standing{Eigen::VectorXd(m), Eigen::VectorXd(m), Eigen::VectorXd(m)};
  constexpr std::ptrdiff_t kChunk = 1 << 16;
  for (Eigen::Index start = 0; start < m; start += kChunk) {
    const Eigen::Index count = std::min<Eigen::Index>(kChunk, m - start);
    pool.For(count, 512, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
      const std::vector<int> near = index.Nearest(points.middleCols(start + begin, end - begin), k);
      std::vector<int> others;
      for (std::ptrdiff_t i = begin; i < end; ++i) {
        const Eigen::Index point = start + i;
        const int* row = near.data() + (i - begin) * k;
        others.clear();  // the point itself stays out of its own plane
        for (int j = 0; j < k; ++j) {
          if (row[j] != point) others.push_back(row[j]);
        }
        std::tie(standing.offset[point], standing.scale[point]) = OffsetAndScale(Neighbourhood(
            points, points.col(point), others.data(), static_cast<int>(others.size())));
        standing.reach[point] = (points.col(row[kReachNeighbour]) - points.col(point)).norm();
      }
    });
    Report(progress,
           "prepare",
           0.3 + 0.7 * static_cast<double>(start + count) / static_cast<double>(m));
  }
  return standing;
}

// Whether a point is much lonelier than the points nearest to it.
bool Isolated(const Eigen::Matrix3Xd& points,
              const NeighbourIndex& index,
              const Eigen::VectorXd& reach,
              Eigen::Index point) {
  const std::vector<int> near = index.Nearest(points.col(point), kReachNeighbour + 1);
  std::vector<double> theirs;
  for (const int j : near) {
    if (j != point) theirs.push_back(reach[j]);
  }
  return reach[point] > kLonelier * Median(std::move(theirs));
}

// Whether most of the points nearest to a point are outliers.
bool AmongOutliers(const Eigen::Matrix3Xd& points,
                   const NeighbourIndex& index,
                   const PointMask& outliers,
                   Eigen::Index point) {
  const std::vector<int> near = index.Nearest(points.col(point), kReachNeighbour + 1);
  return std::count_if(near.begin(), near.end(), [&](int j) { return outliers[j]; }) >
         kReachNeighbour / 2;
}

void FlagOutliers(const Eigen::Matrix3Xd& points,
                  const NeighbourIndex& index,
                  ThreadPool& pool,
                  const Progress& progress,
                  CloudStatistics& result) {
  const Standing standing = MeasureStanding(points, index, pool, progress);
  const double typical = Median(std::vector<double>(standing.scale.begin(), standing.scale.end()));
  const double usual_reach =
      Median(std::vector<double>(standing.reach.begin(), standing.reach.end()));
  const double rounding =
      1e-9 * result.spacing;  // exact data: deviations are rounding or curvature
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const double scale = standing.scale[i];
    const double own = std::max({typical, std::min(scale, 2 * typical), rounding});
    const bool rough = scale > 4 * std::max(typical, rounding);
    const bool off = standing.offset[i] > 4.5 * own || rough;
    const double reach = standing.reach[i];
    // Rough ground stands off planes too, but not by several times the distance of its points.
    // A rib or a step does, but in the company of its own points.
    // Points scattered through space keep each other company, but lie in no surface.
    result.outliers[i] =
        (off && standing.offset[i] > kOutlierInSpacings * result.spacing &&
         reach > kApart * usual_reach) ||
        (rough && reach > kSparser * usual_reach && scale > kFillsSpace * reach) ||
        (reach > kLonelier * usual_reach && Isolated(points, index, standing.reach, i));
  }
  const PointMask surely = result.outliers;
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    if (surely[i] || !(standing.reach[i] > kSparser * usual_reach)) continue;
    result.outliers[i] = AmongOutliers(points, index, surely, i);
  }
}

}  // namespace

std::vector<Eigen::Index> SampleIndices(Eigen::Index size, Eigen::Index count, std::uint64_t seed) {
  std::vector<Eigen::Index> indices;
  if (count >= size) {
    indices.resize(static_cast<size_t>(size));
    std::iota(indices.begin(), indices.end(), Eigen::Index{0});
    return indices;
  }
  // One from each of `count` equal stretches: spread over the file and all different.
  std::mt19937_64 random(seed);
  indices.reserve(static_cast<size_t>(count));
  for (Eigen::Index i = 0; i < count; ++i) {
    const Eigen::Index begin = size * i / count, end = size * (i + 1) / count;
    indices.push_back(
        begin + static_cast<Eigen::Index>(random() % static_cast<std::uint64_t>(end - begin)));
  }
  return indices;
}

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
    Eigen::Matrix3Xd queries(3, end - begin);
    for (auto i = begin; i < end; ++i) queries.col(i - begin) = points.col(samples[i]);
    const std::vector<int> near = index.Nearest(queries, around + 1);
    for (auto i = begin; i < end; ++i) {
      const int farthest = near[(i - begin) * (around + 1) + around];
      radii[i] = (points.col(farthest) - points.col(samples[i])).norm();
    }
  });
  result.spacing = Median(std::move(radii)) * std::sqrt(std::numbers::pi / around);
  if (m < kFewPoints) return result;
  Report(progress, "prepare", 0.1);

  // Where a smaller neighbourhood deviates clearly less, the larger one measured shape, not noise.
  const double wide = m >= 60 ? NoiseAt(points, index, samples, 30, pool) : 0;
  const double narrow = NoiseAt(points, index, samples, 14, pool);
  result.noise = m < 60 || narrow < 0.7 * wide ? narrow : wide;
  Report(progress, "prepare", 0.3);
  if (!options.find_outliers) return result;

  FlagOutliers(points, index, pool, progress, result);
  result.outlier_count = result.outliers.count();
  return result;
}

}  // namespace batten
