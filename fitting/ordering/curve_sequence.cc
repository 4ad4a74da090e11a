// SPDX-License-Identifier: MIT
#include "fitting/ordering/curve_sequence.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

#include "batten/fitting/statistics.h"
#include "geometry/numeric/polygon.h"

namespace batten::internal {
namespace {

constexpr Eigen::Index kAlwaysInOrder = 5;
constexpr Eigen::Index kSamples = 128;     // steps looked at
constexpr Eigen::Index kWitnesses = 1024;  // points they are compared with
constexpr double kShuffled = 0.35;         // share of nearer points; 0.5 ± 0.03 when shuffled
constexpr double kLongStep = 4;            // times a quarter's quantile and the steps nearby
constexpr double kContinues = 2;           // times the steps nearby
constexpr Eigen::Index kLongestVisit = 8;  // points in a row that are outliers
constexpr double kTakenOn = 0.4;           // of the ends of long steps
constexpr Eigen::Index kSequenceBlock = 64;

// One index in each of `count` equal parts of [0, size).
std::vector<Eigen::Index> Spread(Eigen::Index size, Eigen::Index count, std::mt19937_64& random) {
  count = std::min(size, count);
  std::vector<Eigen::Index> result;
  for (Eigen::Index k = 0; k < count; ++k) {
    const Eigen::Index begin = k * size / count, end = (k + 1) * size / count;
    const auto jump = static_cast<Eigen::Index>(random() % static_cast<std::uint64_t>(end - begin));
    result.push_back(begin + jump);
  }
  return result;
}

// For sampled points, the share of others nearer than the point `lag` places on, both ways of going
// through the file.
std::vector<double> SharesNearer(const Eigen::Matrix3Xd& points,
                                 Eigen::Index lag,
                                 std::mt19937_64& random) {
  const std::vector<Eigen::Index> others = Spread(points.cols(), kWitnesses, random);
  std::vector<double> shares;
  for (const Eigen::Index k : Spread(points.cols() - lag, kSamples, random)) {
    const double squared = (points.col(k + lag) - points.col(k)).squaredNorm() * (1 - 1e-9);
    Eigen::Index nearer = 0, counted = 0;
    for (const Eigen::Index other : others) {
      if (other == k || other == k + lag) continue;
      ++counted;
      if ((points.col(other) - points.col(k)).squaredNorm() < squared) ++nearer;
    }
    shares.push_back(static_cast<double>(nearer) / static_cast<double>(counted));
  }
  return shares;
}

double Mean(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

// Boxes around stretches of the file, to look for points near a place.
class Stretches {
 public:
  explicit Stretches(const Eigen::Matrix3Xd& points) : points_(points) {
    for (Eigen::Index begin = 0; begin < points.cols(); begin += kSequenceBlock) {
      const auto block = points.middleCols(begin, std::min(kSequenceBlock, points.cols() - begin));
      low_.push_back(block.rowwise().minCoeff());
      high_.push_back(block.rowwise().maxCoeff());
    }
  }

  // Whether a point farther than `apart` in the file, which is taken as a ring, lies within the
  // radius of point k.
  bool HasNear(Eigen::Index k, double radius, Eigen::Index apart) const {
    const Eigen::Vector3d place = points_.col(k);
    for (size_t b = 0; b < low_.size(); ++b) {
      const Eigen::Array3d outside =
          (low_[b] - place).array().max((place - high_[b]).array()).max(0.0);
      if (outside.matrix().squaredNorm() > radius * radius) continue;
      const Eigen::Index begin = static_cast<Eigen::Index>(b) * kSequenceBlock;
      const Eigen::Index end = std::min(begin + kSequenceBlock, points_.cols());
      for (Eigen::Index j = begin; j < end; ++j) {
        const Eigen::Index between = std::abs(j - k);
        if (std::min(between, points_.cols() - between) <= apart) continue;
        if ((points_.col(j) - place).squaredNorm() <= radius * radius) return true;
      }
    }
    return false;
  }

 private:
  const Eigen::Matrix3Xd& points_;
  std::vector<Eigen::Vector3d> low_, high_;
};

// The steps of the file and how long they are near a point.
class Steps {
 public:
  explicit Steps(const Eigen::Matrix3Xd& points) : lengths_(StepLengths(points)) {
    std::vector<double> positive;
    for (const double length : lengths_) {
      if (length > 0) positive.push_back(length);
    }
    if (!positive.empty()) short_ = Quantile(std::move(positive), 0.25);
  }

  double length(Eigen::Index k) const { return lengths_[k]; }
  double short_step() const { return short_; }  // a quarter is shorter

  // The second shortest of the six steps around a point.
  double Near(Eigen::Index k) const {
    double least = std::numeric_limits<double>::infinity(),
           second = std::numeric_limits<double>::infinity();
    const Eigen::Index end = std::min(k + 3, lengths_.size());
    for (Eigen::Index j = std::max<Eigen::Index>(0, k - 3); j < end; ++j) {
      if (!(lengths_[j] > 0) || lengths_[j] >= second) continue;
      second = std::max(least, lengths_[j]);
      least = std::min(least, lengths_[j]);
    }
    return std::isfinite(second) ? second : short_;
  }

  std::vector<Eigen::Index> Long() const {
    std::vector<Eigen::Index> result;
    for (Eigen::Index k = 0; k < lengths_.size(); ++k) {
      if (lengths_[k] <= kLongStep * short_) continue;
      if (lengths_[k] > kLongStep * std::max(Near(k), Near(k + 1))) result.push_back(k);
    }
    return result;
  }

 private:
  Eigen::VectorXd lengths_;
  double short_ = 0;
};

// Whether the long step from k to k + 1 leaves the curve for a few points in a row, or comes back
// from them: outliers.
bool IsVisit(const Eigen::Matrix3Xd& points, const Steps& steps, Eigen::Index k) {
  const double most = 0.5 * steps.length(k);
  const double before = steps.Near(k), behind = steps.Near(k + 1);
  const Eigen::Index longest = std::clamp<Eigen::Index>(points.cols() / 20, 3, kLongestVisit);
  for (Eigen::Index away = 1; away <= longest; ++away) {
    const double reach = kContinues * static_cast<double>(away + 1);
    const Eigen::Index next = k + away + 1, last = k - away;
    if (next < points.cols() &&
        (points.col(next) - points.col(k)).norm() <= std::min(most, reach * before)) {
      return true;
    }
    if (last >= 0 &&
        (points.col(last) - points.col(k + 1)).norm() <= std::min(most, reach * behind)) {
      return true;
    }
  }
  return false;
}

// Whether long steps lead between runs that belong together otherwise.
bool RunsAreMixed(const Eigen::Matrix3Xd& points, double share_nearer, std::mt19937_64& random) {
  const Steps steps(points);
  const std::vector<Eigen::Index> candidates = steps.Long();
  if (candidates.empty()) return false;
  const Stretches stretches(points);
  const auto count = static_cast<double>(points.cols());
  const auto apart =
      static_cast<Eigen::Index>(std::min(8 + (0.01 + 8 * share_nearer) * count, 0.25 * count));
  Eigen::Index visits = 0, ends = 0, taken_on = 0;
  for (const Eigen::Index s :
       Spread(static_cast<Eigen::Index>(candidates.size()), kSamples / 2, random)) {
    const Eigen::Index k = candidates[static_cast<size_t>(s)];
    if (IsVisit(points, steps, k)) {
      ++visits;
      continue;
    }
    for (const Eigen::Index end : {k, k + 1}) {
      const double reach = std::min(steps.Near(end), kLongStep * steps.short_step());
      ++ends;
      if (stretches.HasNear(end, kContinues * reach, apart)) ++taken_on;
    }
  }
  // Of a single step both ends; where most long steps are outliers', the others are theirs too.
  return static_cast<double>(taken_on) >=
         kTakenOn * (static_cast<double>(ends) + 0.5 * static_cast<double>(visits)) + 0.3;
}

}  // namespace

bool FollowsCurve(const Eigen::Matrix3Xd& points) {
  if (points.cols() <= kAlwaysInOrder) return true;
  std::mt19937_64 random(1);
  const std::vector<double> shares = SharesNearer(points, 1, random);
  if (Mean(shares) > kShuffled && Mean(SharesNearer(points, 2, random)) > kShuffled) return false;
  return !RunsAreMixed(points, Quantile(shares, 0.25), random);
}

}  // namespace batten::internal
