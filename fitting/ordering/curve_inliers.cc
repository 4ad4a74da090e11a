// SPDX-License-Identifier: MIT
#include "fitting/ordering/curve_inliers.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "batten/fitting/neighbours.h"
#include "batten/fitting/statistics.h"
#include "fitting/core/shared_constants.h"
#include "fitting/ordering/curve_nodes.h"

namespace batten::internal {
namespace {

constexpr Eigen::Index kFewest = 100;
constexpr int kFew = 8;         // neighbours asked
constexpr int kMost = 30;       // where noise is thicker than the few are long
constexpr double kRoomy = 1.4;  // times the median distance to the last neighbour
constexpr double kThin = 0.06;  // squared thickness against squared length of neighbours in a row
constexpr double kOffInNoise = 5;
constexpr double kOffInRoom = 0.2;  // share of the distance to the last neighbour
constexpr double kFewOffCurves = 0.01;
constexpr double kThinNoise = 0.1;  // share of the spacing: below it curves are thin

// Whether the point is in a row with its neighbours.
bool InRow(const Eigen::Matrix3Xd& neighbours, const Eigen::Vector3d& point, double room) {
  const LocalParabola local(neighbours);
  const double rest = local.rest.squaredNorm();
  if (!(local.along > 0) || rest > kThin * local.along) return false;
  const double noise = std::sqrt(rest / static_cast<double>(local.x.size() - 3));
  return local.Off(point) <= std::max(kOffInNoise * noise, kOffInRoom * room);
}

// Tests points for linearity of their neighbourhoods in a sample.
class LinearityTest {
 public:
  explicit LinearityTest(const Eigen::Matrix3Xd& points)
      : sample_(EveryFew(points, kNodeSample)), index_(sample_) {
    std::vector<double> rooms(sample_.cols());
    const std::vector<int> nearest = index_.Nearest(sample_, kMost + 1);
    for (Eigen::Index k = 0; k < sample_.cols(); ++k) {
      rooms[k] = Distance(sample_.col(k), &nearest[k * (kMost + 1)], kFew);
    }
    roomy_ = kRoomy * Median(std::move(rooms));
  }

  const Eigen::Matrix3Xd& sample() const { return sample_; }

  // Returns the points that are in a row with their neighbours; with `all` unset, also those that
  // have no more room than most.
  std::vector<int> InRows(const Eigen::Matrix3Xd& points, bool all, ThreadPool& pool) const {
    std::vector<char> keep(points.cols());
    pool.For(points.cols(), kPointsPerTask, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
      const std::vector<int> rows =
          index_.Nearest(points.middleCols(begin, end - begin), kMost + 1);
      for (std::ptrdiff_t k = begin; k < end; ++k) {
        keep[k] = Judge(points.col(k), &rows[(k - begin) * (kMost + 1)], all ? 0 : roomy_);
      }
    });
    std::vector<int> kept;
    for (int k = 0; k < points.cols(); ++k) {
      if (keep[k] != 0) kept.push_back(k);
    }
    return kept;
  }

 private:
  double Distance(const Eigen::Vector3d& point, const int* row, int j) const {
    return (sample_.col(row[j]) - point).norm();
  }

  bool Judge(const Eigen::Vector3d& point, const int* row, double room) const {
    if (Distance(point, row, kFew) <= room) return true;
    const bool itself = sample_.col(row[0]) == point;  // its own nearest
    for (const int k : {kFew, kMost}) {
      const std::vector<int> others(row + itself, row + itself + k);
      if (InRow(sample_(Eigen::all, others), point, Distance(point, row, k))) return true;
    }
    return false;
  }

  Eigen::Matrix3Xd sample_;
  NeighbourIndex index_;
  double roomy_ = 0;
};

}  // namespace

std::vector<int> CurveInliers(const Eigen::Matrix3Xd& points, ThreadPool& pool) {
  std::vector<int> everything(points.cols());
  std::iota(everything.begin(), everything.end(), 0);
  if (points.cols() < kFewest) return everything;
  const LinearityTest linearity(points);
  const auto in_rows =
      static_cast<double>(linearity.InRows(linearity.sample(), false, pool).size());
  if (in_rows > (1 - kFewOffCurves) * static_cast<double>(linearity.sample().cols()))
    return everything;
  std::vector<int> along = linearity.InRows(points, false, pool);
  // Where curves are thin, a point beside one shows even close to it; and one of them shows better
  // among those that are left.
  if (static_cast<Eigen::Index>(along.size()) < kFewest) return along;
  const Eigen::Matrix3Xd left = points(Eigen::all, along);
  const CurveScale scale = ScaleOfCurves(left);
  if (scale.noise >= kThinNoise * scale.spacing) return along;
  return LinearityTest(left).InRows(points, true, pool);
}

}  // namespace batten::internal
