// SPDX-License-Identifier: MIT
#include "fitting/parameterization/normal_cone.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace batten::internal {
namespace {

// Position of a quantile in a sorted sample: an index and a fraction of the way to the next.
struct Position {
  Position(double fraction, Eigen::Index count) {
    const double at = std::clamp(fraction, 0.0, 1.0) * static_cast<double>(count - 1);
    index = static_cast<std::ptrdiff_t>(at);
    part = at - static_cast<double>(index);
  }
  std::ptrdiff_t index;
  double part;
};

// Two low quantiles of the cosines with an axis, round by round. An axis moves little in a round:
// only cosines not far above the quantile of the last one need be ordered.
class LowCosines {
 public:
  LowCosines(const Eigen::Matrix3Xd& normals, const NormalConeOptions& options)
      : normals_(normals),
        options_(options),
        first_(options.share, normals.cols()),
        second_(2 * options.share, normals.cols()),
        cosines_(normals.cols()) {}

  double low() const { return low_; }

  void Measure(const Eigen::Vector3d& axis) {
    cosines_.noalias() = axis.transpose() * normals_;
    if (!options_.one_sided) cosines_ = cosines_.cwiseAbs();
    constexpr double kAbove = 0.1;
    Collect(high_ + kAbove);
    if (std::ssize(indices_) <= second_.index + 1) Collect(HUGE_VAL);
    values_.clear();
    for (const Eigen::Index k : indices_) values_.push_back(cosines_[k]);
    const auto begin = values_.begin(), at = begin + second_.index;
    std::nth_element(begin, at, values_.end());
    high_ = Between(*at, at + 1, values_.end(), second_.part);
    std::nth_element(begin, begin + first_.index, at + 1);
    const auto next = begin + first_.index + 1;
    low_ = next <= at ? Between(*(next - 1), next, at + 1, first_.part)
                      : Between(*at, next, values_.end(), first_.part);
  }

  // Returns the sum of the normals between the quantiles, on the axis's side.
  Eigen::Vector3d Steep(const Eigen::Vector3d& axis) const {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const Eigen::Index k : indices_) {
      if (cosines_[k] < low_ || cosines_[k] > high_) continue;
      const Eigen::Vector3d normal = normals_.col(k);
      sum += !options_.one_sided && normal.dot(axis) < 0 ? (-normal).eval() : normal;
    }
    return sum;
  }

 private:
  using Iterator = std::vector<double>::iterator;

  static double Between(double value, Iterator next, Iterator end, double part) {
    return next == end ? value : value + part * (*std::min_element(next, end) - value);
  }

  void Collect(double most) {
    indices_.clear();
    for (Eigen::Index k = 0; k < cosines_.size(); ++k)
      if (cosines_[k] <= most) indices_.push_back(k);
  }

  const Eigen::Matrix3Xd& normals_;
  const NormalConeOptions& options_;
  Position first_, second_;
  Eigen::RowVectorXd cosines_;
  std::vector<Eigen::Index> indices_;  // of the low ones
  std::vector<double> values_;
  double low_ = 0, high_ = HUGE_VAL;
};

}  // namespace

Eigen::Vector3d NormalCone(const Eigen::Matrix3Xd& normals,
                           const Eigen::Vector3d& start,
                           const NormalConeOptions& options) {
  Eigen::Vector3d axis = start, best = start;
  if (normals.cols() == 0) return best;
  LowCosines cosines(normals, options);
  double most_open = -HUGE_VAL;
  for (int round = 1; round <= options.rounds; ++round) {
    cosines.Measure(axis);
    if (cosines.low() > most_open) {
      most_open = cosines.low();
      best = axis;
    }
    const Eigen::Vector3d steep = cosines.Steep(axis);
    if (!(steep.norm() > 0)) break;
    axis = (axis + steep.normalized() / (1.0 + round)).normalized();
  }
  return best;
}

}  // namespace batten::internal
