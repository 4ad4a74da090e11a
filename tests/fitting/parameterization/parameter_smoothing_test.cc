// SPDX-License-Identifier: MIT
#include "fitting/parameterization/parameter_smoothing.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "bent_sheets.h"
#include "flat_bases.h"
#include "tolerances.h"

namespace batten::internal::parameter_smoothing_test {

constexpr double kSigma = 2e-3;

// Waves of so many spacings of the points, of half the height along and across.
Parameterization Wrinkled(Parameterization base, double length, double height) {
  const double spacing =
      std::sqrt(base.length_u * base.length_v / static_cast<double>(base.parameters.cols()));
  const double turns = 2 * std::numbers::pi / (length * spacing);
  Eigen::Matrix2Xd moved = base.parameters;
  for (Eigen::Index k = 0; k < moved.cols(); ++k) {
    const double u = base.parameters(0, k), v = base.parameters(1, k);
    moved.col(k) += height * Eigen::Vector2d(std::sin(turns * u) * std::cos(turns * v),
                                             0.5 * std::cos(turns * u) * std::sin(turns * v));
  }
  base.parameters = Inside(base, moved);
  return base;
}

// One in `leave_out` is moved, but not asked for the score.
struct Settled {
  Parameterization base;
  bool any;
  BaseScore::Value before, after;
};

Settled Settle(const Eigen::Matrix3Xd& points,
               const Parameterization& base,
               const PointMask& mask,
               int threads = 2,
               Eigen::Index leave_out = std::numeric_limits<Eigen::Index>::max()) {
  ThreadPool pool(threads);
  const PointCloud cloud(points);
  const SurfaceFitOptions options;
  std::vector<Eigen::Index> kept;
  for (Eigen::Index k = 0; k < mask.size(); ++k) {
    if (mask[k] && k % leave_out != 0) kept.push_back(k);
  }
  const BaseScore score(cloud, kept, options, pool);
  const PointMask all = PointMask::Constant(cloud.size(), true);
  Settled settled{base, false, score.Of(base, all), {}};
  const BaseScore::Value own = score.Of(base, score.sample() && mask);
  settled.any = SmoothParameters(settled.base, cloud, mask, score, own, pool).has_value();
  settled.after = score.Of(settled.base, all);
  return settled;
}

PointMask All(const Eigen::Matrix3Xd& points) { return PointMask::Constant(points.cols(), true); }

void ExpectInside(const Parameterization& base) {
  EXPECT_TRUE(base.parameters.allFinite());
  EXPECT_EQ(Inside(base, base.parameters), base.parameters);
}

TEST(SmoothParametersTest, NeverRaisesTheScore) {
  for (const BentSheet& sheet : {ArcSheet(220), SBend()}) {
    for (const double height : {0.0, 5e-3, 0.05}) {
      SCOPED_TRACE(sheet.name + ", wrinkles of " + std::to_string(height));
      const SheetPoints cloud =
          PointsOn(sheet, {.count = 1500, .sigma = kSigma, .isotropic = true, .seed = 2});
      const Parameterization base = Wrinkled(FlatBase(sheet, cloud), 12, height);
      const Settled settled = Settle(cloud.points, base, All(cloud.points));
      ExpectInside(settled.base);
      // By 2e-4 where control points are clearly fewer, at most six times.
      EXPECT_LE(settled.after.score, 1.0012 * settled.before.score);
      if (settled.any) {
        EXPECT_TRUE(settled.after.score < 0.9995 * settled.before.score ||
                    settled.after.control_points < 0.8 * settled.before.control_points);
      } else {
        EXPECT_EQ(settled.base.parameters, base.parameters);
      }
    }
  }
}

TEST(SmoothParametersTest, TakesWrinklesOut) {
  const BentSheet sheet = ArcSheet(220);
  const SheetPoints cloud = PointsOn(sheet, {.count = 3000, .sigma = kSigma});
  const Parameterization flat = FlatBase(sheet, cloud);
  ThreadPool pool(2);
  const PointCloud points(cloud.points);
  const SurfaceFitOptions options;
  const double clean = BaseScore(points, AllOf(cloud.points), options, pool)
                           .Of(flat, PointMask::Constant(points.size(), true))
                           .score;
  const Settled settled = Settle(cloud.points, Wrinkled(flat, 10, 0.03), All(cloud.points));
  EXPECT_TRUE(settled.any);
  EXPECT_GT(settled.before.score, 1.3 * clean);
  // Most of what they cost is gone.
  EXPECT_LT(settled.after.score - clean, 0.5 * (settled.before.score - clean));
  EXPECT_LT(settled.after.control_points, settled.before.control_points);
}

TEST(SmoothParametersTest, LeavesPointsAloneThatAreNotUnderTheMask) {
  const BentSheet sheet = ArcSheet(220);
  SheetPoints cloud = PointsOn(sheet, {.count = 2000, .sigma = kSigma});
  PointMask mask = All(cloud.points);
  for (Eigen::Index k = 0; k < 2000; k += 7) {
    mask[k] = false;
    cloud.points.col(k) *= 1.5;
  }
  const Parameterization base = Wrinkled(FlatBase(sheet, cloud), 10, 0.03);
  const Settled settled = Settle(cloud.points, base, mask, 2, 3);
  ASSERT_TRUE(settled.any);
  Eigen::Index moved = 0;
  for (Eigen::Index k = 0; k < 2000; ++k) {
    if (mask[k]) {
      moved += settled.base.parameters.col(k) != base.parameters.col(k);
    } else {
      EXPECT_EQ(settled.base.parameters.col(k), base.parameters.col(k));
    }
  }
  EXPECT_GT(moved, mask.count() * 9 / 10);
  // Points that are not under the mask have no say.
  cloud.points.col(0) *= 3;
  EXPECT_EQ(Settle(cloud.points, base, mask, 2, 3).base.parameters, settled.base.parameters);
}

TEST(SmoothParametersTest, DoesNotDependOnUnitsOrThreads) {
  const BentSheet sheet = SBend();
  const SheetPoints cloud = PointsOn(sheet, {.count = 1200, .sigma = kSigma, .isotropic = true});
  const Parameterization base = Wrinkled(FlatBase(sheet, cloud), 10, 0.03);
  const Settled one = Settle(cloud.points, base, All(cloud.points), 1);
  ASSERT_TRUE(one.any);
  EXPECT_EQ(Settle(cloud.points, base, All(cloud.points), 3).base.parameters, one.base.parameters);
  for (const double unit : {1e-6, 1e6}) {
    SCOPED_TRACE("unit " + std::to_string(unit));
    const Settled other = Settle(unit * cloud.points, InUnit(unit, base), All(cloud.points));
    EXPECT_TRUE(other.any);
    EXPECT_LE((other.base.parameters / unit - one.base.parameters).cwiseAbs().maxCoeff(),
              kHalfDigits * base.length_u);
  }
}

}  // namespace batten::internal::parameter_smoothing_test
