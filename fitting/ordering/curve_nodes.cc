// SPDX-License-Identifier: MIT
#include "fitting/ordering/curve_nodes.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "batten/fitting/neighbours.h"
#include "batten/fitting/statistics.h"
#include "geometry/numeric/dense_solvers.h"
#include "geometry/numeric/point_kd_tree.h"

namespace batten::internal {
namespace {

constexpr Eigen::Index kAsked = 300;  // of which so many are asked
constexpr int kFewestAround = 10;
constexpr int kManyAround = 64;  // are enough mostly
constexpr int kMostAround = 500;
constexpr double kThinNodes =
    0.03;  // squared thickness against squared length of a thin neighbourhood
constexpr int kShifts = 5;
constexpr double kReachInNoise = 6;  // radius of the ball whose middle is taken
constexpr double kRidgeInNoise = 3;
constexpr double kOffRidge = 0.35;

struct RowNoise {
  double noise = 0;
  bool sure = false;
};

// The noise of the first of these neighbours that are longer than thick. Few points can look like a
// row by chance; twice they hardly do.
RowNoise NoiseAround(const Eigen::Matrix3Xd& sample, const int* nearest, int most) {
  double noise = 0;
  int thin = 0;
  for (int k = kFewestAround; k <= most && thin < 2; k += k / 4) {
    const LocalParabola local(sample(Eigen::all, std::vector<int>(nearest, nearest + k)));
    thin = local.along > 0 && local.rest.squaredNorm() <= kThinNodes * local.along ? thin + 1 : 0;
    noise = std::sqrt(local.rest.col(1).squaredNorm() / (k - 3));
  }
  return {thin > 0 ? noise : 0, thin == 2};
}

// The middle of the points in a ball and the direction in which they run.
struct Middle {
  Eigen::Vector3d place, direction;
  double count = 0;
};

Middle MiddleOf(const PointKdTree& tree,
                const Eigen::Matrix3Xd& points,
                const Eigen::Vector3d& centre,
                double radius) {
  double total = 0;
  Eigen::Vector3d first = Eigen::Vector3d::Zero();
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
  Middle middle;
  tree.ForBall(centre, radius, [&](int k, double square) {
    const double bell = 1 - square / (radius * radius), weight = bell * bell;
    const Eigen::Vector3d arm = points.col(k) - centre;
    total += weight;
    first += weight * arm;
    second.noalias() += weight * arm * arm.transpose();
    ++middle.count;
  });
  middle.place = centre;
  middle.direction.setZero();
  if (!(total > 0)) return middle;
  first /= total;
  const SymmetricEigen3 axes = QuickEigenOf3(second / total - first * first.transpose());
  middle.direction = axes.vectors.col(2);
  middle.place += first - middle.direction * middle.direction.dot(first);
  return middle;
}

// Thins points greedily in the given order of preference: no two points kept are nearer than
// `radius`, and every other point is within it of one kept.
std::vector<int> Thinned(const Eigen::Matrix3Xd& points,
                         double radius,
                         const std::vector<int>& preference) {
  if (!(radius > 0)) return preference;
  const PointKdTree tree(points);
  std::vector<bool> covered(points.cols(), false);
  std::vector<int> kept;
  for (const int k : preference) {
    if (covered[k]) continue;
    kept.push_back(k);
    tree.ForBall(points.col(k), radius, [&](int other, double) { covered[other] = true; });
  }
  return kept;
}

// How many points are near each node, against the most near any node around it: little between two
// curves, a half at an end.
Eigen::VectorXd OnRidge(const PointKdTree& tree,
                        const Eigen::Matrix3Xd& nodes,
                        double near,
                        double around) {
  Eigen::VectorXd counts(nodes.cols()), most(nodes.cols());
  for (Eigen::Index i = 0; i < nodes.cols(); ++i) {
    double count = 0;
    tree.ForBall(nodes.col(i), near, [&](int, double) { ++count; });
    counts[i] = count;
  }
  const PointKdTree node_tree(nodes);
  for (Eigen::Index i = 0; i < nodes.cols(); ++i) {
    double largest = 1;
    node_tree.ForBall(
        nodes.col(i), around, [&](int k, double) { largest = std::max(largest, counts[k]); });
    most[i] = largest;
  }
  return counts.cwiseQuotient(most);
}

}  // namespace

LocalParabola::LocalParabola(const Eigen::Matrix3Xd& points) : middle(points.rowwise().mean()) {
  const Eigen::Matrix3Xd local = points.colwise() - middle;
  const SymmetricEigen3 axes = QuickEigenOf3(local * local.transpose());
  frame = axes.vectors;
  along = axes.values[2];
  const Eigen::MatrixX2d across = local.transpose() * frame.leftCols<2>();
  x = local.transpose() * frame.col(2) / std::sqrt(along > 0 ? along : 1);
  Eigen::MatrixX3d powers(x.size(), 3);
  powers << Eigen::VectorXd::Ones(x.size()), x, x.cwiseAbs2();
  const Eigen::Matrix3d gram = powers.transpose() * powers;
  coefficients = SymmetricSolution(gram, powers.transpose() * across);
  rest = across - powers * coefficients;
}

double LocalParabola::Off(const Eigen::Vector3d& point) const {
  const Eigen::Vector3d own = frame.transpose() * (point - middle);
  const double at = std::clamp(own[2] / std::sqrt(along), x.minCoeff(), x.maxCoeff());
  return (own.head<2>().transpose() - Eigen::RowVector3d(1, at, at * at) * coefficients).norm();
}

double SigmaOfDistances(std::vector<double> distances, int rank) {
  constexpr double kMedianOfTwo = 0.8493218002880191;  // 1 / sqrt(2 log 2)
  return Median(std::move(distances)) * (rank <= 2 ? kMadToSigma : kMedianOfTwo);
}

Eigen::Matrix3Xd EveryFew(const Eigen::Matrix3Xd& points, Eigen::Index most) {
  const Eigen::Index count = std::min(points.cols(), most);
  Eigen::Matrix3Xd few(3, count);
  for (Eigen::Index k = 0; k < count; ++k) few.col(k) = points.col(k * points.cols() / count);
  return few;
}

CurveScale ScaleOfCurves(const Eigen::Matrix3Xd& points) {
  CurveScale scale;
  if (points.cols() < 2) return scale;
  const Eigen::Matrix3Xd sample = EveryFew(points, kNodeSample);
  const Eigen::Matrix3Xd asked = EveryFew(sample, kAsked);
  const NeighbourIndex index(sample);
  std::vector<double> noises(static_cast<size_t>(asked.cols()), 0.0), spacings;
  std::vector<Eigen::Index> open(static_cast<size_t>(asked.cols()));
  std::iota(open.begin(), open.end(), Eigen::Index{0});
  for (const int around : {kManyAround, kMostAround}) {
    const int most = static_cast<int>(std::min<Eigen::Index>(around, sample.cols()));
    const std::vector<int> nearest = index.Nearest(asked(Eigen::all, open), most);
    std::vector<Eigen::Index> undecided;
    for (size_t i = 0; i < open.size(); ++i) {
      const int* const row = &nearest[i * static_cast<size_t>(most)];
      if (around == kManyAround)
        spacings.push_back((sample.col(row[std::min(2, most - 1)]) - asked.col(open[i])).norm());
      const RowNoise found = NoiseAround(sample, row, most);
      noises[static_cast<size_t>(open[i])] = found.noise;
      if (!found.sure && most < sample.cols()) undecided.push_back(open[i]);
    }
    open = std::move(undecided);
    if (open.empty()) break;
  }
  scale.spacing = Median(std::move(spacings)) * static_cast<double>(sample.cols()) /
                  static_cast<double>(points.cols());
  if (sample.cols() >= kFewestAround + 2) scale.noise = Median(std::move(noises));
  return scale;
}

Eigen::Matrix3Xd CurveNodes(const Eigen::Matrix3Xd& points,
                            double noise,
                            double radius,
                            ThreadPool& pool) {
  std::vector<int> order(points.cols());
  std::iota(order.begin(), order.end(), 0);
  if (!(noise > 0)) return points(Eigen::all, Thinned(points, radius, order));
  Eigen::Matrix3Xd nodes =
      points(Eigen::all, Thinned(points, std::min(radius / 2, noise * 1.5), order));
  const double reach = kReachInNoise * noise;
  const PointKdTree tree(points);
  std::vector<double> counts(nodes.cols());
  pool.For(nodes.cols(), 64, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (std::ptrdiff_t i = begin; i < end; ++i) {
      for (int round = 0; round < kShifts; ++round) {
        const Middle middle = MiddleOf(tree, points, nodes.col(i), reach);
        nodes.col(i) = middle.place;
        counts[i] = middle.count;
      }
    }
  });
  const Eigen::VectorXd ridge = OnRidge(tree, nodes, kRidgeInNoise * noise, reach);
  order.clear();
  for (int i = 0; i < nodes.cols(); ++i) {
    if (ridge[i] >= kOffRidge) order.push_back(i);
  }
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return counts[a] > counts[b]; });
  return nodes(Eigen::all, Thinned(nodes, radius, order));
}

}  // namespace batten::internal
