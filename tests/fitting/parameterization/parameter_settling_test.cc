// SPDX-License-Identifier: MIT
#include "fitting/parameterization/parameter_settling.h"

#include <gtest/gtest.h>

#include <cmath>

#include "sheet_oracle.h"

namespace batten::internal::parameter_settling_test {

// A ramp whose parameters are off by up to a twentieth of its width, as maps of sheets are.
struct Ramp {
  Ramp() : points(PointsOn(HelicalRamp(1.15), {.count = 6000, .sigma = 1e-3, .seed = 3})) {
    base.length_u = 6;
    base.length_v = 1;
    base.parameters.resize(2, points.parameters.cols());
    for (Eigen::Index k = 0; k < points.parameters.cols(); ++k) {
      const double u = points.parameters(0, k), v = points.parameters(1, k);
      base.parameters(0, k) = 6 * (u + 0.02 * std::sin(6 * u + 4 * v));
      base.parameters(1, k) = v + 0.05 * std::sin(9 * u) * v * (1 - v);
    }
    base.parameters = base.parameters.array().max(0);
    base.parameters.row(0) = base.parameters.row(0).cwiseMin(base.length_u);
  }

  bool Settle(const BaseScore::Value* rival) {
    const PointMask all = PointMask::Constant(points.points.cols(), true);
    return SettleParameters(base, PointCloud(points.points), all, all, 0.01, rival, pool);
  }

  SheetPoints points;
  Parameterization base;
  ThreadPool pool{2};
};

TEST(SettleParametersTest, MovesNothingBehindARivalOfFewerControlPoints) {
  Ramp behind;
  const Eigen::Matrix2Xd before = behind.base.parameters;
  const BaseScore::Value rival{.score = 1e-12, .cells_u = 1, .cells_v = 1, .control_points = 16};
  EXPECT_FALSE(behind.Settle(&rival));
  EXPECT_EQ(behind.base.parameters, before);
  EXPECT_EQ(behind.base.settled_cells_u, 0);
}

TEST(SettleParametersTest, SettlesAsWithoutOneBeforeARivalThatIsWorseOrNeedsMore) {
  Ramp alone;
  ASSERT_TRUE(alone.Settle(nullptr));
  EXPECT_GT(alone.base.settled_cells_u, 0);
  for (const BaseScore::Value& rival :
       {BaseScore::Value{1, 1, 1, 16}, BaseScore::Value{1e-12, 40, 40, 1849}}) {
    Ramp beside;
    ASSERT_TRUE(beside.Settle(&rival));
    EXPECT_EQ(beside.base.parameters, alone.base.parameters);
    EXPECT_EQ(beside.base.settled_cells_u, alone.base.settled_cells_u);
  }
}

}  // namespace batten::internal::parameter_settling_test
