// SPDX-License-Identifier: MIT
#include "batten/geometry/regularity.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "exact_shapes.h"
#include "random_splines.h"
#include "trim_cases.h"

namespace batten::internal::regularity_test {

// Degree 3 × 1 over x(u), z(u): an extruded curve along y.
NurbsSurface Extruded(const SplineBasis& basis, const Eigen::Matrix2Xd& profile) {
  Eigen::Matrix3Xd net(3, 2 * profile.cols());
  for (Eigen::Index i = 0; i < profile.cols(); ++i)
    for (int j = 0; j < 2; ++j) net.col(2 * i + j) << profile(0, i), j, profile(1, i);
  return {basis, SplineBasis(1, {0, 0, 1, 1}), net};
}

bool InOneOf(const std::vector<ParameterBox>& boxes, double u, double v) {
  return std::any_of(boxes.begin(), boxes.end(), [&](const ParameterBox& box) {
    return u >= box.u0 && u <= box.u1 && v >= box.v0 && v <= box.v1;
  });
}

TEST(RegularityTest, SheetsWithoutFoldsAreProved) {
  RandomSplines random(4);
  for (int k = 0; k < 6; ++k) {
    const NurbsSurface sheet = random.Sheet(2 + k % 3, 3, 0.3);
    EXPECT_TRUE(UnprovedRegularity(sheet).empty());
    EXPECT_TRUE(UnprovedRegularity(sheet.Translated({5e5, 5e6, 100})).empty());
    const Eigen::VectorXd weights = random.Weights(sheet.control_points().cols(), 0.9, 1.1);
    EXPECT_TRUE(UnprovedRegularity(
                    {sheet.basis_u(), sheet.basis_v(), 1e-6 * sheet.control_points(), weights})
                    .empty());
  }
}

// Where x turns back, along a line, and nowhere far from it.
TEST(RegularityTest, FoldsStayOpen) {
  const SplineBasis cubic(3, {0, 0, 0, 0, 1, 1, 1, 1});
  Eigen::Matrix2Xd profile(2, 4);
  profile << 0, 2, -1, 1, 0, 0, 0, 0;  // flat: folded onto itself
  const NurbsSurface folded = Extruded(cubic, profile);
  const std::vector<ParameterBox> open = UnprovedRegularity(folded);
  // x' = 6 − 30 u + 30 u² vanishes there.
  for (const double u : {0.5 - std::sqrt(0.05), 0.5 + std::sqrt(0.05)})
    for (const double v : {0.1, 0.5, 0.9}) EXPECT_TRUE(InOneOf(open, u, v)) << u;
  for (const double u : {0.1, 0.5, 0.9}) EXPECT_FALSE(InOneOf(open, u, 0.5)) << u;
  // The part between them is trimmed away with both of them.
  const NurbsSurface kept = Trimmed(folded, {RectangleLoop(0.8, 0.95, 0.1, 0.9)});
  EXPECT_TRUE(UnprovedRegularity(kept).empty());
}

TEST(RegularityTest, CreasesAreProvedUnlessTheyTurnOver) {
  const SplineBasis line(1, {0, 0, 1, 2, 2});
  Eigen::Matrix2Xd roof(2, 3), knife(2, 3);
  roof << 0, 1, 2, 0, 5, 0;  // 157 degrees at the ridge
  knife << 0, 1, 0, 0, 0, 0;
  EXPECT_TRUE(UnprovedRegularity(Extruded(line, roof)).empty());
  const std::vector<ParameterBox> open = UnprovedRegularity(Extruded(line, knife));
  ASSERT_FALSE(open.empty());
  for (const ParameterBox& box : open) {
    EXPECT_EQ(box.u0, 1);
    EXPECT_EQ(box.u1, 1);
  }
  for (const double v : {0.01, 0.4, 0.99}) EXPECT_TRUE(InOneOf(open, 1, v)) << v;
}

TEST(RegularityTest, OfSpheresOnlyThePolesStayOpen) {
  const NurbsSurface sphere = Sphere(3);
  const std::vector<ParameterBox> open = UnprovedRegularity(sphere);
  ASSERT_FALSE(open.empty());
  for (const ParameterBox& box : open) {
    const Eigen::Vector3d at = sphere.At((box.u0 + box.u1) / 2, (box.v0 + box.v1) / 2);
    EXPECT_GT(std::abs(at[2]), 2.98);
  }
  EXPECT_TRUE(UnprovedRegularity(Cylinder(3, 10)).empty());
  EXPECT_TRUE(UnprovedRegularity(Torus(3, 1)).empty());
}

}  // namespace batten::internal::regularity_test
