// SPDX-License-Identifier: MIT
#include "fitting/primitives/line_fit.h"

#include "fitting/primitives/shape_descent.h"
#include "geometry/numeric/constants.h"
#include "geometry/numeric/dense_solvers.h"

namespace batten::internal {
namespace {

// Σ w, Σ w x, Σ w x xᵀ, x taken from a point of the line.
struct Moments {
  double sum = 0;
  Eigen::Vector3d first = Eigen::Vector3d::Zero();
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();

  void operator+=(const Moments& other) {
    sum += other.sum;
    first += other.first;
    second += other.second;
  }
};

// Weights are multiplied by the loss's at the distances from `line`.
Moments MomentsOf(const FittedLine& line,
                  const ShapeData& data,
                  const ShapeLoss& loss,
                  ThreadPool& pool) {
  const auto moments_of = [&](Eigen::Index begin, Eigen::Index end) {
    Moments part;
    for (Eigen::Index k = begin; k < end; ++k) {
      const Eigen::Vector3d from = data.points.col(k) - line.point;
      double weight = data.weights[k];
      if (loss.loss != Loss::kNone) {
        weight *= LossWeight(loss.loss, line.Distance(data.points.col(k)), loss.scale);
      }
      part.sum += weight;
      part.first += weight * from;
      part.second += weight * from * from.transpose();
    }
    return part;
  };
  return SumOfBlocks<kSumBlock>(data.points.cols(), moments_of, pool);
}

// The axis of least inertia.
FittedLine LineOf(const FittedLine& from, const Moments& moments, bool plane) {
  const Eigen::Vector3d mean = moments.first / moments.sum;
  const Eigen::Matrix3d inertia = moments.second - moments.sum * mean * mean.transpose();
  FittedLine line;
  line.point = from.point + mean;
  if (plane) {
    const SymmetricEigen axes = EigenOf(inertia.topLeftCorner<2, 2>());
    line.direction << axes.vectors.col(1), 0;
  } else {
    line.direction = EigenOf3(inertia).vectors.col(2);
  }
  line.direction.normalize();
  if (line.direction.dot(from.direction) < 0) line.direction = -line.direction;
  return line;
}

}  // namespace

std::optional<FittedLine> FittedLine::Through(const Eigen::Matrix3Xd& sample) {
  const Eigen::Vector3d along = sample.col(1) - sample.col(0);
  const double length = along.norm();
  if (!(length > 0)) return std::nullopt;
  return FittedLine{sample.col(0), along / length};
}

FittedLine FittedLine::Start(const ShapeData& data, ThreadPool& pool) {
  const FittedLine axis{data.points.col(0), Eigen::Vector3d::UnitX()};
  // Repeated from its own centroid to avoid cancellation.
  const FittedLine rough = LineOf(axis, MomentsOf(axis, data, {}, pool), data.plane);
  return LineOf(rough, MomentsOf(rough, data, {}, pool), data.plane);
}

FittedLine FittedLine::Minimised(const ShapeData& data,
                                 const ShapeLoss& loss,
                                 int most_steps,
                                 ThreadPool& pool) const {
  if (loss.loss == Loss::kNone) return Start(data, pool);
  FittedLine line = *this;
  for (int step = 0; step < most_steps; ++step) {
    const Moments moments = MomentsOf(line, data, loss, pool);
    if (!(moments.sum > 0)) break;
    const FittedLine next = LineOf(line, moments, data.plane);
    const double moved = (next.direction - line.direction).norm() + line.Distance(next.point);
    line = next;
    if (moved <= 4 * kEpsilon) break;
  }
  return line;
}

}  // namespace batten::internal
