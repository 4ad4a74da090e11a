// SPDX-License-Identifier: MIT
#include "fitting/cloud/inlier_prescreen.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "fitting/cloud/cloud_constants.h"
#include "fitting/cloud/quadric_fit_kernels.h"
#include "fitting/core/shared_constants.h"
#include "geometry/numeric/dense_solvers.h"

namespace batten::internal {
namespace {

constexpr double kNarrow = 0.02;       // variance across over along; below, points are on a line
constexpr double kCommon = 1.5;        // root mean square, in deviations; above, a patch is skipped
constexpr double kMost = 0.85;         // share of the points that must agree
constexpr float kMostLeverage = 0.5F;  // above, the other points do not determine the quadric there
constexpr double kWithinReaches = 2.25;  // at a patch's corner only a quarter of a disc is seen
constexpr double kLink = 1.5;            // reaches between connected points
constexpr double kRidge = 1e-6;

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

// One patch of points, scaled to unit size.
class Place {
 public:
  // `chosen` are kPatchPoints points.
  Place(const Eigen::Matrix3Xd& points, const int* chosen) {
    Eigen::Matrix<double, 3, kPatchPoints> local;
    for (int k = 0; k < kPatchPoints; ++k) local.col(k) = points.col(chosen[k]);
    local.colwise() -= Eigen::Vector3d(local.rowwise().mean());
    unit_ = local.cwiseAbs().maxCoeff();
    const double factor = unit_ > 0 ? 1 / unit_ : 0;
    for (int k = 0; k < kPatchPoints; ++k) {
      points_.x[k] = static_cast<float>(local(0, k) * factor);
      points_.y[k] = static_cast<float>(local(1, k) * factor);
      points_.z[k] = static_cast<float>(local(2, k) * factor);
    }
  }

  // Marks the inliers among the patch's points.
  void Judge(double deviation, double reach, bool* good) {
    if (!(unit_ > 0) || !std::isfinite(unit_) || !TakeFrame()) return;
    const double least =
        std::max(deviation / unit_, kExactInReaches * std::min(reach_, kLonelier * reach / unit_));
    if (!Agree(static_cast<float>(least))) return;
    int counts[kPatchPoints], groups[kPatchPoints];
    LinkWithin(points_,
               static_cast<float>(kWithinReaches * reach_),
               static_cast<float>(kLink * reach_),
               counts,
               groups);
    // A quadric would also fit a clump beside the other points.
    int members[kPatchPoints] = {};
    for (const int group : groups) ++members[group];
    const auto body = static_cast<int>(std::max_element(members, members + kPatchPoints) - members);
    if (members[body] < kMost * kPatchPoints) return;
    const auto limit = static_cast<float>(kThreeSigmas * least);
    for (int k = 0; k < kPatchPoints; ++k) {
      good[k] = groups[k] == body && counts[k] > kReachNeighbour &&
                fit_.leverages[k] < kMostLeverage &&
                std::abs(fit_.heights[k]) <= limit * (1 - fit_.leverages[k]);
    }
  }

 private:
  // Rotates the points into their principal frame, and estimates their reach from the area they
  // cover, assuming even density. Returns false if they lie on a line.
  bool TakeFrame() {
    double m[6];
    SecondMoments(points_, m);
    const Eigen::Matrix3d moments{{m[0], m[1], m[2]}, {m[1], m[3], m[4]}, {m[2], m[4], m[5]}};
    const SymmetricEigen3 solver = QuickEigenOf3(moments);
    const Eigen::Vector3d variance = solver.values / kPatchPoints;
    if (!(variance[1] > kNarrow * variance[2])) return false;
    // A rectangle's variances are a twelfth of its sides' squares.
    const double area = 12 * std::sqrt(variance[1] * variance[2]);
    reach_ = std::sqrt(area * kReachNeighbour / (kPatchPoints * std::numbers::pi));
    float axes[9];
    for (int a = 0; a < 3; ++a) {
      for (int b = 0; b < 3; ++b) axes[a * 3 + b] = static_cast<float>(solver.vectors(b, 2 - a));
    }
    TurnInto(axes, points_);
    return true;
  }

  // Fits the quadric robustly, with weights scaled by `deviation`. Returns whether most points
  // agree.
  bool Agree(float deviation) {
    std::fill_n(fit_.weights, kPatchPoints, 1.0F);
    for (int round = 0; round < kRobustRounds; ++round) {
      if (!Solve()) return false;
      int agree = 0;
      float squares = 0;
      for (int k = 0; k < kPatchPoints; ++k) {
        const float ratio = fit_.heights[k] / deviation;
        const bool agrees = std::abs(ratio) <= static_cast<float>(kThreeSigmas);
        agree += agrees ? 1 : 0;
        squares += agrees ? ratio * ratio : 0;
        fit_.weights[k] = 1 / (1 + ratio * ratio / 4);
      }
      // Weights have begun to separate outliers from the rest, or there are no outliers.
      const bool settled = round > 0 || agree == kPatchPoints;
      if (settled && agree >= kMost * kPatchPoints && squares <= kCommon * kCommon * agree)
        return true;
    }
    return false;
  }

  bool Solve() {
    double sums[27];
    AddUpQuadric(points_, fit_.weights, sums);
    Matrix6 matrix = Matrix6::Zero();
    Vector6 right;
    int at = 0;
    for (int a = 0; a < 6; ++a)
      for (int b = 0; b <= a; ++b) matrix(a, b) = sums[at++];
    for (int a = 0; a < 6; ++a) right[a] = sums[at++];
    matrix.diagonal().array() += kRidge * matrix(0, 0);
    const Eigen::LLT<Matrix6> factor(matrix);
    if (factor.info() != Eigen::Success) return false;
    const Eigen::Matrix<float, 6, 1> coefficients = factor.solve(right).cast<float>();
    const Eigen::Matrix<float, 6, 6> inverse = factor.solve(Matrix6::Identity()).cast<float>();
    LeaveQuadric(points_, coefficients.data(), inverse.data(), fit_);
    return true;
  }

  PlacePoints points_;
  PlaceFit fit_;
  double unit_ = 0, reach_ = 0;
};

}  // namespace

PointMask PrescreenInliers(const Eigen::Matrix3Xd& points,
                           const NeighbourIndex& index,
                           double deviation,
                           double reach,
                           ThreadPool& pool) {
  PointMask good = PointMask::Constant(points.cols(), false);
  const auto order = index.order();
  pool.For(points.cols() / kPatchPoints,
           kPointsPerTask / kPatchPoints,
           [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
             for (std::ptrdiff_t i = begin; i < end; ++i) {
               const int* chosen = order.data() + i * kPatchPoints;
               bool plain[kPatchPoints] = {};
               Place(points, chosen).Judge(deviation, reach, plain);
               for (int k = 0; k < kPatchPoints; ++k) good[chosen[k]] = plain[k];
             }
           });
  return good;
}

}  // namespace batten::internal
