// SPDX-License-Identifier: MIT
#include "batten/fitting/point_cloud.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>
#include "fitting/core/mask_indices.h"

namespace batten {
namespace {

constexpr double kLargest = std::numeric_limits<double>::max();

void RequireFit(Eigen::Index count, Eigen::Index points, const char* field) {
  if (count != 0 && count != points) {
    throw std::invalid_argument(std::string("PointCloud: ") + field + " has " +
                                std::to_string(count) + " entries for " + std::to_string(points) +
                                " points");
  }
}

void RequireFinite(bool finite, const char* field) {
  if (!finite) throw std::invalid_argument(std::string("PointCloud: ") + field + " is not finite");
}

// A multiple of a power of two not above the extent, near the middle of the range: its few digits
// make the subtraction exact wherever the input's own digits allow. Zero where the range is near
// zero.
double RoundOrigin(double low, double high) {
  const double middle = low / 2 + high / 2, extent = high - low;
  if (std::abs(middle) <= 16 * extent || middle == 0) return 0;
  const double unit = extent > 0 ? std::exp2(std::floor(std::log2(extent)))
                                 : std::exp2(std::floor(std::log2(std::abs(middle))));
  return std::round(middle / unit) * unit;
}

// Eigen's allFinite() and row-wise extremes take each number by itself; these loops, several at
// once, which shows in reading large files.
bool AllFinite(const Eigen::Matrix3Xd& points) {
  const double* const numbers = points.data();
  int bad = 0;
  for (Eigen::Index k = 0; k < points.size(); ++k) bad |= !(std::abs(numbers[k]) <= kLargest);
  return bad == 0;
}

struct Extent {
  Eigen::Vector3d low, high;
  bool finite;
};

// The bounding box of at least one point, in one pass.
Extent ExtentOf(const Eigen::Matrix3Xd& points) {
  constexpr int kLanes = 6;  // two points beside each other
  double low[kLanes], high[kLanes];
  const double* const numbers = points.data();
  for (int d = 0; d < kLanes; ++d) low[d] = high[d] = numbers[d % 3];
  int bad = 0;
  const auto take = [&](const double* from, int lanes) {
    for (int d = 0; d < lanes; ++d) {
      const double x = from[d];
      low[d] = x < low[d] ? x : low[d];
      high[d] = x > high[d] ? x : high[d];
      bad |= !(std::abs(x) <= kLargest);
    }
  };
  const Eigen::Index whole = points.size() / kLanes * kLanes;
  for (Eigen::Index k = 0; k < whole; k += kLanes) take(numbers + k, kLanes);
  if (whole < points.size()) take(numbers + whole, 3);
  Extent extent{{}, {}, bad == 0};
  for (int d = 0; d < 3; ++d) {
    extent.low[d] = std::min(low[d], low[d + 3]);
    extent.high[d] = std::max(high[d], high[d + 3]);
  }
  return extent;
}

}  // namespace

PointCloud::PointCloud(Eigen::Matrix3Xd points, Eigen::Vector3d origin, int dimension)
    : points_(std::make_shared<const Eigen::Matrix3Xd>(std::move(points))),
      origin_(std::move(origin)),
      dimension_(dimension) {
  if (dimension_ != 2 && dimension_ != 3) {
    throw std::invalid_argument("PointCloud: dimension must be 2 or 3");
  }
  RequireFinite(AllFinite(*points_), "a point");
  RequireFinite(origin_.allFinite(), "the origin");
}

PointCloud PointCloud::FromWorld(Eigen::Matrix3Xd points, int dimension) {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  if (points.cols() > 0) {
    const Extent extent = ExtentOf(points);
    RequireFinite(extent.finite, "a point");
    for (int d = 0; d < 3; ++d) origin[d] = RoundOrigin(extent.low[d], extent.high[d]);
    if (!origin.isZero(0)) points.colwise() -= origin;
  }
  // What is finite stays so near to an origin inside its own range.
  PointCloud cloud(Eigen::Matrix3Xd(3, 0), origin, dimension);
  cloud.points_ = std::make_shared<const Eigen::Matrix3Xd>(std::move(points));
  return cloud;
}

void PointCloud::set_normals(Eigen::Matrix3Xd normals) {
  RequireFit(normals.cols(), size(), "normals");
  RequireFinite(normals.allFinite(), "a normal");
  normals_ = std::move(normals);
}

void PointCloud::set_weights(Eigen::VectorXd weights) {
  RequireFit(weights.size(), size(), "weights");
  RequireFinite(weights.allFinite(), "a weight");
  if (weights.size() > 0 && !(weights.minCoeff() > 0)) {
    throw std::invalid_argument("PointCloud: a weight is not positive");
  }
  weights_ = std::move(weights);
}

void PointCloud::set_colours(Colours colours) {
  RequireFit(colours.cols(), size(), "colours");
  colours_ = std::move(colours);
}

void PointCloud::set_parameters(Eigen::Matrix2Xd parameters) {
  RequireFit(parameters.cols(), size(), "parameters");
  RequireFinite(parameters.allFinite(), "a parameter");
  parameters_ = std::move(parameters);
}

PointCloud PointCloud::Subset(const Eigen::Array<bool, Eigen::Dynamic, 1>& keep) const {
  if (keep.size() != size()) {
    throw std::invalid_argument("PointCloud::Subset: the mask has " + std::to_string(keep.size()) +
                                " entries for " + std::to_string(size()) + " points");
  }
  return Picked(internal::IndicesOf(keep));
}

PointCloud PointCloud::Picked(const std::vector<Eigen::Index>& kept) const {
  PointCloud result((*points_)(Eigen::all, kept), origin_, dimension_);
  if (normals_.cols() > 0) result.normals_ = normals_(Eigen::all, kept);
  if (weights_.size() > 0) result.weights_ = weights_(kept);
  if (colours_.cols() > 0) result.colours_ = colours_(Eigen::all, kept);
  if (parameters_.cols() > 0) result.parameters_ = parameters_(Eigen::all, kept);
  return result;
}

namespace {

std::uint64_t HashOf(const Eigen::Vector3d& p) {
  std::uint64_t hash = 0;
  for (const double x : p) {
    // Adding zero makes one of the two zeros; then multiply and fold.
    hash = (hash ^ std::bit_cast<std::uint64_t>(x + 0.0)) * 0x9E3779B97F4A7C15u;
    hash ^= hash >> 32;
  }
  return hash;
}

struct HashedPoint {
  std::uint32_t hash, point;  // the hash's upper half: the lower one chose the block
};

// Points under their hashes, block by block, each in the order of the points.
struct HashBlocks {
  std::vector<HashedPoint> points;
  std::vector<Eigen::Index> begins;  // one more than blocks
};

HashBlocks BlocksOf(const Eigen::Matrix3Xd& p) {
  constexpr std::uint64_t kPerBlock = 8192;  // a block and its table stay in the cache
  constexpr std::uint64_t kMostBlocks = 4096;
  const auto m = static_cast<std::uint64_t>(p.cols());
  const std::uint64_t blocks = std::min(std::bit_ceil(m / kPerBlock + 1), kMostBlocks);
  HashBlocks result{std::vector<HashedPoint>(m), std::vector<Eigen::Index>(blocks + 1)};
  for (Eigen::Index k = 0; k < p.cols(); ++k)
    ++result.begins[(HashOf(p.col(k)) & (blocks - 1)) + 1];
  std::partial_sum(result.begins.begin(), result.begins.end(), result.begins.begin());
  std::vector<Eigen::Index> next(result.begins.begin(), result.begins.end() - 1);
  for (Eigen::Index k = 0; k < p.cols(); ++k) {
    const std::uint64_t hash = HashOf(p.col(k));
    result.points[static_cast<size_t>(next[hash & (blocks - 1)]++)] = {
        static_cast<std::uint32_t>(hash >> 32), static_cast<std::uint32_t>(k)};
  }
  return result;
}

// Finds for every point the first one at its place, by a small open-addressing hash table for each
// block of hashes. [Knuth 1998, 6.4, algorithm L]
std::vector<Eigen::Index> FirstAtPlace(const Eigen::Matrix3Xd& p) {
  constexpr std::uint32_t kFree = ~std::uint32_t{0};
  const HashBlocks blocks = BlocksOf(p);
  std::vector<Eigen::Index> first(static_cast<size_t>(p.cols()));
  std::vector<HashedPoint> table;
  for (size_t block = 0; block + 1 < blocks.begins.size(); ++block) {
    const Eigen::Index begin = blocks.begins[block], end = blocks.begins[block + 1];
    const std::uint64_t size = std::bit_ceil(static_cast<std::uint64_t>(2 * (end - begin) + 2));
    table.assign(size, {0, kFree});
    for (Eigen::Index i = begin; i < end; ++i) {
      const HashedPoint& own = blocks.points[static_cast<size_t>(i)];
      // The upper bits choose the slot, since hashes of numbers of few digits agree in their low
      // bits.
      std::uint64_t at = own.hash * size >> 32;
      const auto other = [&](const HashedPoint& held) {
        return held.hash != own.hash || p.col(held.point) != p.col(own.point);
      };
      while (table[at].point != kFree && other(table[at])) at = (at + 1) & (size - 1);
      if (table[at].point == kFree) table[at] = own;
      first[own.point] = table[at].point;
    }
  }
  return first;
}

}  // namespace

MergedCloud MergeDuplicates(const PointCloud& cloud) {
  const Eigen::Index m = cloud.size();
  std::vector<Eigen::Index> first = FirstAtPlace(cloud.points());
  MergedCloud result;
  result.cloud = cloud;
  for (Eigen::Index k = 0; k < m; ++k) result.duplicates += first[k] != k ? 1 : 0;
  result.place = std::move(first);
  if (result.duplicates == 0) return result;
  Eigen::VectorXd weights =
      cloud.weights().size() > 0 ? cloud.weights() : Eigen::VectorXd::Ones(m).eval();
  Eigen::Array<bool, Eigen::Dynamic, 1> keep(m);
  std::vector<Eigen::Index> rank(static_cast<size_t>(m));
  Eigen::Index kept = 0;
  for (Eigen::Index k = 0; k < m; ++k) {
    Eigen::Index& stands = result.place[static_cast<size_t>(k)];
    keep[k] = stands == k;
    if (keep[k]) {
      rank[static_cast<size_t>(k)] = kept++;
    } else {
      weights[stands] += weights[k];
    }
    stands = rank[static_cast<size_t>(stands)];
  }
  result.cloud.set_weights(std::move(weights));
  result.cloud = result.cloud.Subset(keep);
  return result;
}

}  // namespace batten
