// SPDX-License-Identifier: MIT
#include "batten/geometry/bicubic_patch.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "random_splines.h"
#include "refusal.h"
#include "tolerances.h"

namespace batten::internal::bicubic_patch_test {

using ::testing::HasSubstr;

TEST(BicubicPatchTest, HasTheGivenDataAtItsCorners) {
  for (int seed = 0; seed < 20; ++seed) {
    RandomSplines random(seed);
    PatchCorners corners;
    for (int k = 0; k < 4; ++k) {
      corners.points[k] = random.Vector(5);
      corners.tangents_u[k] = random.Vector(5);
      corners.tangents_v[k] = random.Vector(5);
      corners.twists[k] = random.Vector(5);
    }
    const NurbsSurface patch = BicubicPatch(corners);
    for (int k = 0; k < 4; ++k) {
      const SurfaceJet jet = patch.JetAt(k % 2, k / 2);
      EXPECT_EQ(jet.point, corners.points[k]);
      EXPECT_LE((jet.du - corners.tangents_u[k]).norm(), 100 * kRounding);
      EXPECT_LE((jet.dv - corners.tangents_v[k]).norm(), 100 * kRounding);
      EXPECT_LE((jet.duv - corners.twists[k]).norm(), 1000 * kRounding);
    }
  }
  EXPECT_THAT(RefusalOf([] {
                BicubicPatch({{Eigen::Vector3d::Zero(),
                               Eigen::Vector3d::Zero(),
                               Eigen::Vector3d::Zero(),
                               Eigen::Vector3d::Zero()},
                              {Eigen::Vector3d::Zero(),
                               Eigen::Vector3d::Zero(),
                               Eigen::Vector3d::Zero(),
                               Eigen::Vector3d::Zero()},
                              {Eigen::Vector3d::Zero(),
                               Eigen::Vector3d::Zero(),
                               Eigen::Vector3d::Zero(),
                               Eigen::Vector3d::Zero()}});
              }),
              HasSubstr("one point"));
}

}  // namespace batten::internal::bicubic_patch_test
