// SPDX-License-Identifier: MIT
#include "fitting/primitives/normal_axes.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "batten/fitting/robust_loss.h"
#include "fitting/core/rounding.h"
#include "geometry/numeric/dense_solvers.h"

namespace batten::internal {
namespace {

// Iterative reweighting by Cauchy's loss at the median residual, for linear problems:
// solve(weights) returns residuals.
template <typename Solve>
void Reweight(Eigen::Index count, const Solve& solve) {
  constexpr int kRounds = 4;
  Eigen::VectorXd weights = Eigen::VectorXd::Ones(count);
  for (int round = 0; round < kRounds; ++round) {
    const Eigen::VectorXd residuals = solve(weights);
    const double scale = RobustScale(residuals) + kRelativeRounding;
    weights = LossWeights(Loss::kCauchy, residuals, scale);
  }
}

}  // namespace

Eigen::Matrix3d AcrossNormals(const OrientedPoints& oriented) {
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
  Reweight(oriented.normals.cols(), [&](const Eigen::VectorXd& weights) -> Eigen::VectorXd {
    axes = EigenOf3(oriented.normals * weights.asDiagonal() * oriented.normals.transpose()).vectors;
    return oriented.normals.transpose() * axes.col(0);
  });
  return axes;
}

std::vector<Axis> LinesMeetingNormals(const OrientedPoints& oriented, double towards_centroid) {
  const Eigen::Index count = oriented.points.cols();
  const Eigen::Vector3d centroid = oriented.points.rowwise().mean();
  Eigen::Matrix<double, 6, Eigen::Dynamic> rows(6, count);
  for (Eigen::Index k = 0; k < count; ++k) {
    const Eigen::Vector3d n = oriented.normals.col(k);
    rows.col(k) << (oriented.points.col(k) - centroid).cross(n), n;
  }
  std::vector<Axis> axes;
  Reweight(count, [&](const Eigen::VectorXd& weights) -> Eigen::VectorXd {
    const Eigen::Matrix<double, 6, 6> m = rows * weights.asDiagonal() * rows.transpose();
    const Eigen::Matrix3d shifts = m.bottomRightCorner<3, 3>() +
                                   towards_centroid * weights.sum() * Eigen::Matrix3d::Identity();
    const Eigen::Matrix3d to_shift = -SymmetricSolutions3(shifts, m.bottomLeftCorner<3, 3>());
    const Eigen::Matrix3d reduced = m.topLeftCorner<3, 3>() + m.topRightCorner<3, 3>() * to_shift;
    const Eigen::Matrix3d turns = EigenOf3((reduced + reduced.transpose()) / 2).vectors;
    axes.clear();
    for (int i = 0; i < 3; ++i) {
      const Eigen::Vector3d c = turns.col(i), shift = to_shift * c;
      axes.push_back({centroid + c.cross(shift), c});
    }
    Eigen::Matrix<double, 6, 1> best;
    best << turns.col(0), to_shift * turns.col(0);
    return rows.transpose() * best;
  });
  return axes;
}

std::optional<FittedSurface> ConeOfTangentPlanes(const OrientedPoints& oriented,
                                                 const Eigen::Vector3d& near) {
  const Eigen::Index count = oriented.points.cols();
  const Eigen::VectorXd heights =
      oriented.normals.cwiseProduct(oriented.points).colwise().sum().transpose();
  Eigen::Vector3d apex = Eigen::Vector3d::Zero();
  Reweight(count, [&](const Eigen::VectorXd& weights) -> Eigen::VectorXd {
    const Eigen::Matrix3d m =
        oriented.normals * weights.asDiagonal() * oriented.normals.transpose();
    apex = SymmetricSolution3(m, oriented.normals * weights.cwiseProduct(heights));
    return oriented.normals.transpose() * apex - heights;
  });
  if (!apex.allFinite()) return std::nullopt;
  const Eigen::Matrix3Xd seen = (oriented.points.colwise() - apex).colwise().normalized();
  if (!seen.allFinite()) return std::nullopt;
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();
  double cosine = 0;
  Reweight(count, [&](const Eigen::VectorXd& weights) -> Eigen::VectorXd {
    const Eigen::Vector3d mean = seen * weights / weights.sum();
    const Eigen::Matrix3Xd from = seen.colwise() - mean;
    axis = EigenOf3(from * weights.asDiagonal() * from.transpose()).vectors.col(0);
    cosine = axis.dot(mean);
    return from.transpose() * axis;
  });
  if (cosine < 0) axis = -axis;
  const double angle = std::clamp(std::acos(std::min(1.0, std::abs(cosine))),
                                  kSharpestCone,
                                  std::numbers::pi / 2 - kSharpestCone);
  return ConeNear(near, apex, axis, angle);
}

}  // namespace batten::internal
