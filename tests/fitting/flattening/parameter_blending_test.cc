// SPDX-License-Identifier: MIT
#include "fitting/flattening/parameter_blending.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "bent_sheets.h"
#include "fitting/flattening/poisson_disk_samples.h"
#include "tolerances.h"

namespace batten::internal::parameter_blending_test {

struct Laid {
  SheetGraph graph;
  Flattening unfolding;
};

Laid LayOut(const Eigen::Matrix3Xd& points) {
  ThreadPool pool(2);
  Laid laid;
  laid.graph = ConnectSheet(SamplePoissonDisk(points, NeighbourIndex(points), 0, {}, pool), {});
  laid.unfolding = FlattenArap(laid.graph);
  return laid;
}

Eigen::Matrix2Xd Spread(const Laid& laid, const Eigen::Matrix3Xd& points) {
  ThreadPool pool(2);
  return BlendLocalCharts(laid.graph, laid.unfolding, points, 0, pool).places;
}

TEST(FlattenArapTest, KeepsEveryEdgeOfADevelopableSheet) {
  for (const BentSheet& sheet : {FlatSheet(), ArcSheet(300), SBend(), Roll(), WideningPipe()}) {
    SCOPED_TRACE(sheet.name);
    const Laid laid = LayOut(PointsOn(sheet, {.count = 10000}).points);
    EXPECT_EQ(laid.unfolding.folded, 0);
    for (const auto& [i, j] : laid.graph.edges) {
      const double chord = (laid.graph.nodes.places.col(j) - laid.graph.nodes.places.col(i)).norm();
      const double laid_out = std::abs(laid.unfolding.places[j] - laid.unfolding.places[i]);
      // An arc is longer than its chord, here by at most (κl)²/24 < 2 %.
      EXPECT_NEAR(laid_out / chord, 1, 0.02);
    }
    EXPECT_LE((laid.unfolding.conformal.array().abs() - 1).abs().maxCoeff(), 0.02);
    EXPECT_LE(laid.unfolding.anticonformal.cwiseAbs().maxCoeff(), 0.02);
  }
}

TEST(FlattenArapTest, LaysAFlatSheetOutExactly) {
  const Laid laid = LayOut(PointsOn(FlatSheet(2, 1), {.count = 5000}).points);
  EXPECT_LE(laid.unfolding.distortion, kIterated);
}

// Along a line through the cloud second differences of the places stay as small as those of a
// smooth map: a jump of the map or its gradient between nodes would show as far larger ones.
TEST(BlendLocalChartsTest, IsSmooth) {
  for (const BentSheet& sheet : {ShellSheet(), SphericalCap(100), WideningPipe()}) {
    SCOPED_TRACE(sheet.name);
    const Laid laid = LayOut(PointsOn(sheet, {.count = 20000}).points);
    constexpr int kSteps = 4000;
    Eigen::Matrix3Xd line(3, kSteps);
    for (int k = 0; k < kSteps; ++k) line.col(k) = sheet.at(0.2 + 0.6 * k / kSteps, 0.37);
    const Eigen::Matrix2Xd places = Spread(laid, line);
    const double length = (places.rightCols(1) - places.leftCols(1)).norm();
    const double step = length / kSteps;
    for (int k = 1; k + 1 < kSteps; ++k) {
      const Eigen::Vector2d bend = places.col(k + 1) - 2 * places.col(k) + places.col(k - 1);
      // The second derivative by arc length is of the order of a curvature over the distortion
      // between nodes: 20 is far above it, a jump of a thousandth of the step is 50 times more.
      EXPECT_LE(bend.norm(), 20 * step * step);
    }
  }
}

// The feet of points off the sheet are those of the points on it, to first order.
TEST(BlendLocalChartsTest, DoesNotSeeTheDistanceFromTheSheet) {
  const BentSheet sheet = ArcSheet(220);
  const SheetPoints cloud = PointsOn(sheet, {.count = 10000});
  const Laid laid = LayOut(cloud.points);
  const Eigen::Matrix2Xd on = Spread(laid, cloud.points);
  for (const double off : {-0.01, 0.01}) {
    Eigen::Matrix3Xd beside = cloud.points;
    for (Eigen::Index k = 0; k < beside.cols(); ++k) {
      beside.col(k) += off * sheet.NormalAt(cloud.parameters(0, k), cloud.parameters(1, k));
    }
    // Without the quadrics' correction it were off · κ · distance to the node: up to 1e-3.
    EXPECT_LE((Spread(laid, beside) - on).colwise().norm().maxCoeff(), 0.02 * std::abs(off));
  }
}

}  // namespace batten::internal::parameter_blending_test
