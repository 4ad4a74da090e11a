// SPDX-License-Identifier: MIT
#include "fitting/flattening/poisson_disk_samples.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <numeric>
#include <span>
#include <vector>

#include "batten/fitting/statistics.h"
#include "fitting/core/rounding.h"
#include "fitting/core/shared_constants.h"
#include "geometry/numeric/dense_solvers.h"
#include "geometry/numeric/mixed_bits.h"

namespace batten::internal {
namespace {

constexpr Eigen::Index kCandidatesANode = 10;
constexpr double kReachInSpacings = 1.5;  // at the edge spacings seem up to twice as large
constexpr double kReachInNoise = 4;
constexpr Eigen::Index kFewPoints = 200;  // points; below, all are nodes
constexpr Eigen::Index kPointsANode = 8;  // at least, of more points
constexpr int kCounted = 16;              // neighbours that give the local spacing
// Discs of a diameter thrown at random until none fits cover 0.547 of the plane.
constexpr double kNodesAnArea = 0.547 * 4 / std::numbers::pi;
constexpr int kAround = 30;  // neighbours that show a border by an angle without any
// Radians, on which side no neighbour lies: chance leaves it inside a sheet once in 200 000 places;
// points up to 0.8 spacings from a straight border see as much. [derived: n (1 − a/2π)^(n − 1)]
constexpr double kEdgeGap = 150 * kOneDegree;
constexpr double kReachAlongEdge = 0.65, kReachFromEdge = 0.8;  // of nodes on the border
constexpr double kReachOfNeighbours = 1.5;  // of a node's tangent plane, in reaches
constexpr int kQuadricNeighbours = 10;      // fewer determine a plane only
constexpr int kLeastForPlane = 6;     // points whose plane shows which others are off it: by …
constexpr double kOffInRadii = 0.35;  // … three of their own deviations and so much of the radius
                                      // of all, which curvature explains

// The first `count` indices in an order that looks random and depends on the coordinates only.
std::vector<Eigen::Index> ShuffledByPlace(const Eigen::Matrix3Xd& points, Eigen::Index count) {
  using Key = std::pair<std::uint64_t, Eigen::Index>;
  const Eigen::Index m = points.cols();
  count = std::min(count, m);
  // Keys are spread evenly: of those below a bound there are hardly ever too few.
  const auto keys_below = [&](double share) {
    const std::uint64_t bound =
        share < 1 ? static_cast<std::uint64_t>(std::ldexp(share, 64)) : UINT64_MAX;
    std::vector<Key> keys;
    for (Eigen::Index k = 0; k < m; ++k) {
      const std::uint64_t key = MixedBitsOf(points.data() + 3 * k);
      if (key <= bound) keys.emplace_back(key, k);
    }
    return keys;
  };
  std::vector<Key> keys = keys_below(1.2 * static_cast<double>(count) / static_cast<double>(m));
  if (std::ssize(keys) < count) keys = keys_below(1);
  std::partial_sort(keys.begin(), keys.begin() + count, keys.end());
  std::vector<Eigen::Index> order(static_cast<size_t>(count));
  for (Eigen::Index i = 0; i < count; ++i) order[i] = keys[i].second;
  return order;
}

// Local spacings: the side of the square of area that one point owns, from the radius that holds 16
// points. Queries follow `order`, in which they are near each other.
Eigen::VectorXd LocalSpacings(const Eigen::Matrix3Xd& points,
                              const NeighbourIndex& index,
                              const Eigen::Matrix3Xd& places,
                              std::span<const int> order,
                              ThreadPool& pool) {
  const int k = static_cast<int>(std::min<Eigen::Index>(kCounted + 1, index.size()));
  Eigen::VectorXd spacings(places.cols());
  pool.For(places.cols(), 256, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    const auto some = order.subspan(static_cast<size_t>(begin), static_cast<size_t>(end - begin));
    const std::vector<int> near = index.Nearest(places(Eigen::all, some), k);
    for (size_t i = 0; i < some.size(); ++i) {
      const int last = near[(i + 1) * static_cast<size_t>(k) - 1];
      spacings[some[i]] = (points.col(last) - places.col(some[i])).norm() *
                          std::sqrt(std::numbers::pi / std::max(1, k - 1));
    }
  });
  return spacings;
}

// Computes reaches that give `most` nodes, as equal as the local spacings allow.
Eigen::VectorXd Reaches(const Eigen::VectorXd& spacings, double least, Eigen::Index most) {
  const double floor = std::min(
      kReachInSpacings,
      std::sqrt(kNodesAnArea * static_cast<double>(spacings.size()) / static_cast<double>(most)));
  const auto reaches = [&](double common) {
    return (floor * spacings).cwiseMax(std::max(common, least)).eval();
  };
  const auto nodes = [&](double common) {
    return kNodesAnArea * spacings.cwiseQuotient(reaches(common)).squaredNorm();
  };
  double low = 0, high = spacings.norm();
  for (int step = 0; step < 60; ++step) {
    const double middle = low + (high - low) / 2;
    (nodes(middle) > static_cast<double>(most) ? low : high) = middle;
  }
  return reaches(high);
}

// Those of the places that lie within a radius about one of them, itself included.
std::vector<int> PlacesWithin(const Eigen::Matrix3Xd& places,
                              const NeighbourIndex& index,
                              Eigen::Index i,
                              double radius) {
  constexpr int kFirstLook = 48;
  for (Eigen::Index k = kFirstLook;; k *= 2) {
    std::vector<int> near = index.Nearest(places.col(i), static_cast<int>(k));
    const auto within = [&](int j) { return (places.col(j) - places.col(i)).norm() < radius; };
    if (k < places.cols() && within(near.back())) continue;
    std::erase_if(near, [&](int j) { return !within(j); });
    return near;
  }
}

// Selects the places, in their order, that lie within no earlier one's reach.
std::vector<Eigen::Index> GreedyDiscs(const Eigen::Matrix3Xd& places,
                                      const NeighbourIndex& index,
                                      const Eigen::VectorXd& reach) {
  std::vector<bool> covered(static_cast<size_t>(places.cols()), false);
  std::vector<Eigen::Index> kept;
  for (Eigen::Index i = 0; i < places.cols(); ++i) {
    if (covered[i]) continue;
    kept.push_back(i);
    for (const int j : PlacesWithin(places, index, i, reach[i])) covered[j] = true;
  }
  return kept;
}

// Widest angles between neighbours that are next to each other around a place, seen in the plane of
// all.
Eigen::VectorXd WidestGaps(const Eigen::Matrix3Xd& points,
                           const NeighbourIndex& index,
                           const Eigen::Matrix3Xd& places,
                           std::span<const int> order,
                           ThreadPool& pool) {
  const int k = static_cast<int>(std::min<Eigen::Index>(kAround, index.size()));
  Eigen::VectorXd gaps(places.cols());
  pool.For(places.cols(), 256, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    const auto some = order.subspan(static_cast<size_t>(begin), static_cast<size_t>(end - begin));
    const std::vector<int> near = index.Nearest(places(Eigen::all, some), k);
    std::vector<double> angles;
    for (size_t i = 0; i < some.size(); ++i) {
      const std::span<const int> own(near.data() + i * static_cast<size_t>(k),
                                     static_cast<size_t>(k));
      const Eigen::Matrix3Xd local = points(Eigen::all, own).colwise() - places.col(some[i]);
      const Eigen::Vector3d middle = local.rowwise().mean();
      const SymmetricEigen3 plane =
          QuickEigenOf3((local.colwise() - middle) * (local.colwise() - middle).transpose());
      const Eigen::Matrix2Xd flat = plane.vectors.rightCols<2>().transpose() * local;
      angles.clear();
      for (Eigen::Index j = 0; j < flat.cols(); ++j)
        if (!flat.col(j).isZero(0)) angles.push_back(std::atan2(flat(1, j), flat(0, j)));
      std::sort(angles.begin(), angles.end());
      double widest = angles.empty() ? 0 : angles.front() + 2 * std::numbers::pi - angles.back();
      for (size_t j = 1; j < angles.size(); ++j)
        widest = std::max(widest, angles[j] - angles[j - 1]);
      gaps[some[i]] = widest;
    }
  });
  return gaps;
}

// As GreedyDiscs, but places on the border come first, those with the widest gaps before others.
std::vector<Eigen::Index> DiscsFromTheEdge(const Eigen::Matrix3Xd& places,
                                           const Eigen::VectorXd& reach,
                                           const Eigen::VectorXd& gaps) {
  std::vector<Eigen::Index> order(static_cast<size_t>(places.cols()));
  std::iota(order.begin(), order.end(), 0);
  const auto inner = std::stable_partition(
      order.begin(), order.end(), [&](Eigen::Index i) { return gaps[i] > kEdgeGap; });
  std::stable_sort(
      order.begin(), inner, [&](Eigen::Index a, Eigen::Index b) { return gaps[a] > gaps[b]; });
  const auto edges = inner - order.begin();
  Eigen::VectorXd reaches = reach(order);
  reaches.head(edges) *= kReachAlongEdge;
  const Eigen::Matrix3Xd ordered = places(Eigen::all, order);
  const NeighbourIndex among(ordered);
  std::vector<Eigen::Index> kept;
  std::vector<bool> covered(order.size(), false);
  const auto cover = [&](Eigen::Index i, double radius, Eigen::Index first) {
    for (const int j : PlacesWithin(ordered, among, i, radius))
      if (j >= first) covered[static_cast<size_t>(j)] = true;
  };
  for (Eigen::Index i = 0; i < ordered.cols(); ++i) {
    if (covered[static_cast<size_t>(i)]) continue;
    kept.push_back(order[static_cast<size_t>(i)]);
    cover(i, reaches[i], 0);
    if (i < edges) cover(i, kReachFromEdge * reach[order[static_cast<size_t>(i)]], edges);
  }
  return kept;
}

// Local plane and quadric of the sheet at a node.
struct LocalSheet {
  Eigen::Vector3d place, normal, tangent, curvature;
  double breadth;
};

// Least-squares plane; the place is the foot point of the origin.
LocalSheet AlgebraicPlaneFit(const Eigen::Matrix3Xd& local) {
  const Eigen::Vector3d middle = local.rowwise().mean();
  const Eigen::Matrix3Xd centred = local.colwise() - middle;
  const Eigen::Matrix3d scatter = centred * centred.transpose();
  const double size = scatter.cwiseAbs().maxCoeff();
  const SymmetricEigen3 solver = QuickEigenOf3(scatter / (size > 0 ? size : 1));
  const Eigen::Vector3d spread = solver.values.cwiseMax(0.0).cwiseSqrt();
  const Eigen::Vector3d longest = solver.vectors.col(2);
  LocalSheet sheet;
  sheet.breadth = spread[2] > 0 ? spread[1] / spread[2] : 0;
  sheet.normal = solver.vectors.col(0).normalized();
  sheet.tangent = (longest - sheet.normal * sheet.normal.dot(longest)).normalized();
  sheet.curvature.setZero();
  sheet.place = sheet.normal * sheet.normal.dot(middle);
  return sheet;
}

// Removes points, given nearest first, that are far off the plane of the nearer half: they belong
// to another turn of the sheet.
Eigen::Matrix3Xd OnOneSheet(const Eigen::Matrix3Xd& local) {
  const Eigen::Index half = (local.cols() + 1) / 2;
  if (half < kLeastForPlane) return local;
  const LocalSheet plane = AlgebraicPlaneFit(local.leftCols(half));
  const Eigen::VectorXd off = (local.colwise() - plane.place).transpose() * plane.normal;
  const double scale = std::sqrt(off.head(half).squaredNorm() / static_cast<double>(half));
  const double most =
      kThreeSigmas * scale + kOffInRadii * std::sqrt(local.colwise().squaredNorm().maxCoeff());
  std::vector<Eigen::Index> kept;
  for (Eigen::Index k = 0; k < local.cols(); ++k) {
    if (std::abs(off[k]) <= most) kept.push_back(k);
  }
  return local(Eigen::all, kept);
}

// Fits the least-squares quadric over a plane and moves the plane's place and normal to it:
//   height c0 + c1 x + c2 y + c3 x²/2 + c4 xy + c5 y²/2, in units of the radius.
void BendToQuadric(const Eigen::Matrix3Xd& local, double radius, LocalSheet& sheet) {
  const Eigen::Vector3d binormal = sheet.normal.cross(sheet.tangent);
  Eigen::Matrix<double, 6, 6> gram = Eigen::Matrix<double, 6, 6>::Zero();
  Eigen::Matrix<double, 6, 1> rhs = Eigen::Matrix<double, 6, 1>::Zero(), row;
  for (const auto p : local.colwise()) {
    const double x = sheet.tangent.dot(p) / radius, y = binormal.dot(p) / radius;
    row << 1, x, y, x * x / 2, x * y, y * y / 2;
    gram.noalias() += row * row.transpose();
    rhs += row * (sheet.normal.dot(p) / radius);
  }
  constexpr double kSteady = 1e-5;  // holds back what points on few lines leave open
  gram.diagonal().tail<3>().array() += kSteady * static_cast<double>(local.cols());
  gram.diagonal().array() += 1e-12 * static_cast<double>(local.cols());
  const Eigen::Matrix<double, 6, 1> c = gram.ldlt().solve(rhs);
  if (!c.allFinite() || c.segment<2>(1).norm() > 1) return;
  sheet.place = sheet.normal * (c[0] * radius);
  const Eigen::Vector3d upright = sheet.normal - c[1] * sheet.tangent - c[2] * binormal;
  sheet.normal = upright.normalized();
  sheet.tangent = (sheet.tangent - sheet.normal * sheet.normal.dot(sheet.tangent)).normalized();
  sheet.curvature = c.tail<3>() / (radius * upright.norm());
}

// The sheet through the points near `place`, nearest first.
LocalSheet SheetAround(const Eigen::Vector3d& place, const Eigen::Matrix3Xd& near) {
  const Eigen::Matrix3Xd local = OnOneSheet(near.colwise() - place);
  LocalSheet sheet = AlgebraicPlaneFit(local);
  const double radius = std::sqrt(local.colwise().squaredNorm().maxCoeff());
  if (local.cols() >= kQuadricNeighbours && radius > 0) BendToQuadric(local, radius, sheet);
  sheet.place += place;
  return sheet;
}

}  // namespace

Eigen::Vector3d PoissonDiskSamples::Binormal(Eigen::Index i) const {
  return Eigen::Vector3d(normals.col(i)).cross(Eigen::Vector3d(tangents.col(i)));
}

bool PoissonDiskSamples::LieAlongLines() const {
  constexpr double kThin = 0.05;  // breadth over length
  return Median({breadth.begin(), breadth.end()}) < kThin;
}

void PoissonDiskSamples::Flip(Eigen::Index i) {
  normals.col(i) *= -1;
  // Heights and y change their signs.
  curvature(0, i) *= -1;
  curvature(2, i) *= -1;
}

PoissonDiskSamples PoissonDiskSamples::Picked(const std::vector<Eigen::Index>& indices) const {
  return {places(Eigen::all, indices),
          normals(Eigen::all, indices),
          tangents(Eigen::all, indices),
          curvature(Eigen::all, indices),
          reach(indices),
          breadth(indices)};
}

PoissonDiskSamples SamplePoissonDisk(const Eigen::Matrix3Xd& points,
                                     const NeighbourIndex& index,
                                     double noise,
                                     const PoissonDiskOptions& options,
                                     ThreadPool& pool) {
  const Eigen::Index m = points.cols();
  const std::vector<Eigen::Index> order = ShuffledByPlace(points, kCandidatesANode * options.most);
  const Eigen::Matrix3Xd candidates = points(Eigen::all, order);
  const NeighbourIndex among(candidates, pool);
  const double share = static_cast<double>(candidates.cols()) / static_cast<double>(m);
  const Eigen::VectorXd dense = LocalSpacings(points, index, candidates, among.order(), pool);
  const Eigen::VectorXd spacings = dense / std::sqrt(share);
  const Eigen::Index most =
      std::min(options.most, std::max(std::min(m, kFewPoints), m / kPointsANode));
  const Eigen::VectorXd reach =
      Reaches(spacings, most < m ? kReachInNoise * noise : 0.0, std::min(most, candidates.cols()));
  std::vector<Eigen::Index> kept(static_cast<size_t>(candidates.cols()));
  if (most < m) {
    kept = options.edges_first
               ? DiscsFromTheEdge(
                     candidates, reach, WidestGaps(points, index, candidates, among.order(), pool))
               : GreedyDiscs(candidates, among, reach);
  } else {
    std::iota(kept.begin(), kept.end(), 0);
  }

  const auto n = static_cast<Eigen::Index>(kept.size());
  PoissonDiskSamples nodes{Eigen::Matrix3Xd(3, n),
                           Eigen::Matrix3Xd(3, n),
                           Eigen::Matrix3Xd(3, n),
                           Eigen::Matrix3Xd(3, n),
                           reach(kept),
                           Eigen::VectorXd(n)};
  const Eigen::Matrix3Xd& cloud = options.own_neighbours ? points : candidates;
  const NeighbourIndex& neighbours = options.own_neighbours ? index : among;
  pool.For(n, 64, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (auto i = begin; i < end; ++i) {
      const double spacing = options.own_neighbours ? dense[kept[i]] : spacings[kept[i]];
      const double radius = kReachOfNeighbours * nodes.reach[i] / std::max(spacing, 1e-300);
      const int k = static_cast<int>(std::clamp(std::numbers::pi * radius * radius,
                                                static_cast<double>(options.least_neighbours),
                                                static_cast<double>(options.most_neighbours)));
      const Eigen::Vector3d place = candidates.col(kept[i]);
      const LocalSheet sheet = SheetAround(place, cloud(Eigen::all, neighbours.Nearest(place, k)));
      nodes.places.col(i) = sheet.place;
      nodes.normals.col(i) = sheet.normal;
      nodes.tangents.col(i) = sheet.tangent;
      nodes.curvature.col(i) = sheet.curvature;
      nodes.breadth[i] = sheet.breadth;
    }
  });
  return nodes;
}

}  // namespace batten::internal
