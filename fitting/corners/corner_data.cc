// SPDX-License-Identifier: MIT
#include "fitting/corners/corner_data.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "batten/fitting/statistics.h"
#include "geometry/numeric/polygon.h"

namespace batten::internal {
namespace {

using Eigen::Index;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr Index kReach = 3;         // neighbours on either side of a median
constexpr double kSteady = 0.15;    // in steps: noise below this hardly changes their lengths
constexpr double kGross = 8;        // standard deviations, beyond the steps' size
constexpr double kSteps = 4;        // in median steps: how far a point may be off
constexpr Index kMostBlocks = 200;  // of the polyline that measures the length
constexpr Index kFewestInBlock = 4;

class Outliers {
 public:
  Outliers(const Matrix3Xd& points, const CornerOptions& options)
      : points_(points), closed_(options.closed), gross_(kGross * options.noise) {}

  bool operator()(Index k) const {
    const Index m = points_.cols();
    if (m < 2 * kReach + 1) return false;
    if (!closed_ && (k < kReach || k + kReach >= m)) return false;
    if (IsNear(k, k - 1) || IsNear(k, k + 1)) return false;
    double off = 0;
    for (int d = 0; d < 3; ++d) {
      std::array<double, 2 * kReach + 1> near;
      for (Index i = -kReach; i <= kReach; ++i)
        near[static_cast<size_t>(i + kReach)] = Point(k + i)[d];
      std::nth_element(near.begin(), near.begin() + kReach, near.end());
      off = std::max(off, std::abs(Point(k)[d] - near[kReach]));
    }
    return off > gross_ + kSteps * Step(k);
  }

 private:
  Vector3d Point(Index k) const {
    const Index m = points_.cols();
    return points_.col(k < 0 ? k + m : k >= m ? k - m : k);
  }

  bool IsNear(Index k, Index i) const {
    return (Point(k) - Point(i)).squaredNorm() <= gross_ * gross_;
  }

  // Median distance of neighbours around a point; two outliers make three steps of six long.
  double Step(Index k) const {
    std::array<double, 2 * kReach> steps;
    for (Index i = -kReach; i < kReach; ++i)
      steps[static_cast<size_t>(i + kReach)] = (Point(k + i + 1) - Point(k + i)).norm();
    std::nth_element(steps.begin(), steps.begin() + kReach - 1, steps.end());
    return steps[kReach - 1];
  }

  const Matrix3Xd& points_;
  bool closed_;
  double gross_;
};

double MedianOf(const VectorXd& values) { return Median({values.begin(), values.end()}); }

// Length in space for a unit of the parameters.
double Speed(const Matrix3Xd& points, const VectorXd& parameters) {
  const Index m = points.cols(), blocks = std::clamp<Index>(m / kFewestInBlock, 2, kMostBlocks);
  double length = 0, first = 0, last = 0;
  Vector3d before = Vector3d::Zero();
  for (Index b = 0; b < blocks; ++b) {
    const Index begin = b * m / blocks, count = (b + 1) * m / blocks - begin;
    const Vector3d mean = points.middleCols(begin, count).rowwise().mean();
    last = parameters.segment(begin, count).mean();
    if (b == 0) first = last;
    if (b > 0) length += (mean - before).norm();
    before = mean;
  }
  return length / (last - first);
}

}  // namespace

double CornerData::ParameterAt(double place) const {
  const Index m = lengths.size();
  const Index above = std::upper_bound(lengths.begin(), lengths.end(), place) - lengths.begin();
  const Index k = std::clamp<Index>(above - 1, 0, m - 1);
  const bool end = k + 1 == m;
  const double next_length = end ? length : lengths[k + 1],
               next = end ? parameters[0] + range : parameters[k + 1],
               gap = next_length - lengths[k];
  const double share = gap > 0 ? std::clamp((place - lengths[k]) / gap, 0.0, 1.0) : 0.0;
  return parameters[k] + share * (next - parameters[k]);
}

std::vector<Index> WithoutOutliers(const Matrix3Xd& points, const CornerOptions& options) {
  const Outliers is_outlier(points, options);
  std::vector<Index> kept;
  for (Index k = 0; k < points.cols(); ++k) {
    if (!is_outlier(k)) kept.push_back(k);
  }
  return kept;
}

CornerData CornerDataOf(const Matrix3Xd& points,
                        const VectorXd& parameters,
                        const CornerOptions& options) {
  const std::vector<Index> kept = WithoutOutliers(points, options);
  CornerData data;
  data.points = points(Eigen::all, kept);
  data.parameters = parameters(kept);
  const Index m = data.parameters.size();
  const Index all = parameters.size();
  const double step = MedianOf(parameters.tail(all - 1) - parameters.head(all - 1));
  const auto way = [&](double gap, Index steps) {
    const double usual = static_cast<double>(steps) * step;
    return steps > 1 && gap > kSteps * usual ? usual : gap;
  };
  data.lengths.resize(m);
  data.lengths[0] = 0;
  for (Index k = 1; k < m; ++k) {
    const auto i = static_cast<size_t>(k);
    data.lengths[k] = data.lengths[k - 1] +
                      way(data.parameters[k] - data.parameters[k - 1], kept[i] - kept[i - 1]);
  }
  data.range = data.parameters[m - 1] - data.parameters[0];
  data.length = data.lengths[m - 1];
  if (options.closed) {
    data.length += way(options.period - data.range, points.cols() - kept.back() + kept.front());
    data.range = options.period;
  }
  const VectorXd steps = StepLengths(data.points);
  if (options.noise <= kSteady * MedianOf(steps)) {
    for (Index k = 1; k < m; ++k) data.lengths[k] = data.lengths[k - 1] + steps[k - 1];
    data.length = data.lengths[m - 1];
    if (options.closed) data.length += (data.points.col(m - 1) - data.points.col(0)).norm();
    return data;
  }
  const double speed = Speed(data.points, data.lengths);
  data.lengths *= speed;
  data.length *= speed;
  return data;
}

}  // namespace batten::internal
