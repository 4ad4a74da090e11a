// SPDX-License-Identifier: MIT
#include "fitting/wings/sheet_sides.h"

#include <gtest/gtest.h>

#include "batten/fitting/cloud_statistics.h"
#include "wings.h"

namespace batten::internal::sheet_sides_test {

struct Case {
  WingShape shape;
  Eigen::Index count;
  double sigma;
};

// Law: of labelled points off the nose and 5 % of the chord before the edge, 99.9 % face the side
// they are on, and nearly all are labelled.
TEST(SheetSidesTest, LabelsAreRightAwayFromTheEdge) {
  unsigned seed = 1;
  for (const Case& one : {Case{{}, 40000, 5e-4},
                          Case{{.thickness = 0.09, .camber = 0.03, .taper = 0.7}, 40000, 3e-4},
                          Case{{.thickness = 0.18, .span = 1.8, .twist = 0.1}, 20000, 8e-4}}) {
    SCOPED_TRACE(seed);
    const WingCloud cloud = PointsOverWing(MapOf(one.shape), one.count, one.sigma, seed++);
    const SheetSides sides = TellSidesApart(cloud.points, NeighbourIndex(cloud.points), one.sigma);
    ASSERT_EQ(sides.failure_reason, "");
    Eigen::Index judged = 0, labelled = 0, upwards = 0;
    for (Eigen::Index k = 0; k < cloud.at.cols(); ++k) {
      // The nose is at about one half of the section's length.
      const double u = cloud.at(0, k), from_nose = std::abs(u - 0.5);
      if (from_nose < 0.1 || from_nose > 0.475) continue;
      ++judged;
      if (!sides.labelled[k]) continue;
      ++labelled;
      upwards += (sides.normals(2, k) > 0) == (u < 0.5) ? 1 : 0;
    }
    // Which side counts as outer is open.
    EXPECT_GE(static_cast<double>(std::max(upwards, labelled - upwards)),
              0.999 * static_cast<double>(labelled));
    EXPECT_GE(static_cast<double>(labelled), 0.98 * static_cast<double>(judged));
  }
}

// Law: the moat lies where sections end, before the edge and perhaps at the nose: between them,
// where the sides are far apart, hardly any of it.
TEST(SheetSidesTest, TheMoatIsWhereSectionsEnd) {
  const WingCloud cloud = PointsOverWing(MapOf({}), 40000, 5e-4, 5);
  const SheetSides sides = TellSidesApart(cloud.points, NeighbourIndex(cloud.points), 5e-4);
  ASSERT_EQ(sides.failure_reason, "");
  Eigen::Index at_edge = 0, between = 0;
  for (Eigen::Index k = 0; k < cloud.at.cols(); ++k) {
    const double from_nose = std::abs(cloud.at(0, k) - 0.5);
    at_edge += sides.moat[k] && from_nose > 0.45 ? 1 : 0;
    between += sides.moat[k] && from_nose > 0.1 && from_nose < 0.4 ? 1 : 0;
  }
  EXPECT_GT(at_edge, 200);
  EXPECT_LE(static_cast<double>(between), 0.01 * static_cast<double>(sides.moat.count()));
}

}  // namespace batten::internal::sheet_sides_test
