// SPDX-License-Identifier: MIT
#include "fitting/flattening/rectangle_base.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vector>

#include "batten/fitting/cloud_statistics.h"
#include "bent_sheets.h"
#include "fitting/flattening/border_corners.h"
#include "fitting/flattening/rectangle_map.h"
#include "fitting/flattening/sheet_triangulation.h"

namespace batten::internal::rectangle_base_test {

using ::testing::HasSubstr;

constexpr double kSigma = 1e-3;

SheetPoints NoisyPoints(const BentSheet& sheet, Eigen::Index count, unsigned seed) {
  return PointsOn(sheet, {.count = count, .sigma = kSigma, .isotropic = true, .seed = seed});
}

SheetGraph GraphOn(const Eigen::Matrix3Xd& points) {
  ThreadPool pool(2);
  PoissonDiskOptions options;
  options.edges_first = true;
  options.own_neighbours = true;
  options.most_neighbours = 24;
  return ConnectSheet(SamplePoissonDisk(points, NeighbourIndex(points), kSigma, options, pool),
                      {.longest = 2.2});
}

RectangleLayout LayoutOf(const Eigen::Matrix3Xd& points,
                         const NeighbourIndex& index,
                         ThreadPool& pool) {
  return {points, index, kSigma, 0, pool};
}

std::vector<BentSheet> FourSidedSheets() {
  return {HelicalRamp(1.15), HelicalRamp(2.5), HelicalRamp(3, 0.35, 1, 0.8), SBend(200)};
}

TEST(RectangleMapTest, IsOneToOneOnSheetsThatWindOverThemselves) {
  for (const BentSheet& sheet : FourSidedSheets()) {
    for (unsigned seed = 1; seed <= 2; ++seed) {
      SCOPED_TRACE(sheet.name + ", seed " + std::to_string(seed));
      const SheetPoints cloud = NoisyPoints(sheet, 20000, seed);
      const SheetGraph graph = GraphOn(cloud.points);
      const SheetTriangulation surface = TriangulateSheet(graph);
      ASSERT_EQ(surface.vertices, graph.nodes.size());
      EXPECT_EQ(surface.euler_characteristic(), 2 - static_cast<int>(surface.loops.size()));
      const BorderCorners corners = FourCornersOf(graph.nodes, surface.loops.front(), 0.6);
      ASSERT_EQ(corners.failure_reason, "");
      EXPECT_EQ(MapOntoRectangle(graph.nodes.places, surface, corners.at).flipped, 0);
    }
  }
}

// No edge belongs to more than two triangles, and neighbours look to the same side.
TEST(SheetTriangulationTest, IsASurfaceWithOneUpperSide) {
  const SheetGraph graph = GraphOn(NoisyPoints(HelicalRamp(2.5), 20000, 3).points);
  std::vector<std::pair<int, int>> edges;
  for (const auto& t : TriangulateSheet(graph).triangles) {
    for (size_t k = 0; k < 3; ++k) edges.emplace_back(t[k], t[(k + 1) % 3]);
    const Eigen::Vector3d a = graph.nodes.places.col(t[1]) - graph.nodes.places.col(t[0]),
                          b = graph.nodes.places.col(t[2]) - graph.nodes.places.col(t[0]);
    EXPECT_GT(a.cross(b).dot(graph.nodes.normals.col(t[0])), 0);
  }
  std::sort(edges.begin(), edges.end());
  EXPECT_EQ(std::adjacent_find(edges.begin(), edges.end()), edges.end());
}

TEST(BorderCornersTest, AreThoseOfTheRamp) {
  const BentSheet ramp = HelicalRamp(1.6);
  const SheetGraph graph = GraphOn(NoisyPoints(ramp, 20000, 5).points);
  const std::vector<int> loop = TriangulateSheet(graph).loops.front();
  const BorderCorners corners = FourCornersOf(graph.nodes, loop, 0.6);
  ASSERT_EQ(corners.failure_reason, "");
  for (const double u : {0.0, 1.0}) {
    for (const double v : {0.0, 1.0}) {
      double nearest = 1;
      for (const size_t k : corners.at)
        nearest = std::min(nearest, (graph.nodes.places.col(loop[k]) - ramp.at(u, v)).norm());
      EXPECT_LE(nearest, graph.nodes.reach.maxCoeff());
    }
  }
}

// Along the ramp the parameter is the angle, to what the ends cost: lengths along both edges are
// proportional to it.
TEST(RectangleLayoutTest, WindsAlongTheRamp) {
  for (const double turns : {1.15, 2.5}) {
    SCOPED_TRACE(turns);
    const SheetPoints cloud = NoisyPoints(HelicalRamp(turns), 20000, 2);
    ThreadPool pool(2);
    const NeighbourIndex index(cloud.points);
    const RectangleLayout layout = LayoutOf(cloud.points, index, pool);
    ASSERT_EQ(layout.failure_reason(), "");
    const FlattenedBase found = layout.Over(cloud.points);
    EXPECT_TRUE(found.reached.all());
    EXPECT_GT(found.length_u, found.length_v);
    const Eigen::RowVectorXd share = found.parameters.row(0) / found.length_u;
    const double misfit = (share - cloud.parameters.row(0)).cwiseAbs().maxCoeff(),
                 turned = (share + cloud.parameters.row(0)).array().abs().maxCoeff() - 1;
    EXPECT_LE(std::min(misfit, std::abs(turned)), 0.02);
  }
}

TEST(RectangleLayoutTest, SaysWhyThereIsNone) {
  const auto why = [](const BentSheet& sheet) {
    const SheetPoints cloud = NoisyPoints(sheet, 8000, 1);
    ThreadPool pool(2);
    const NeighbourIndex index(cloud.points);
    return LayoutOf(cloud.points, index, pool).failure_reason();
  };
  EXPECT_THAT(why(DiscShaped(FlatSheet(1, 1))), HasSubstr("four corners"));
  EXPECT_THAT(why(SphericalCap(120)), HasSubstr("four corners"));
  EXPECT_THAT(why(ArcSheet(360)), HasSubstr("two borders"));
}

TEST(RectangleLayoutTest, IsTheSameOnEveryNumberOfThreads) {
  const SheetPoints cloud = NoisyPoints(HelicalRamp(1.15), 6000, 4);
  const NeighbourIndex index(cloud.points);
  ThreadPool one(1), three(3);
  EXPECT_EQ(LayoutOf(cloud.points, index, one).Over(cloud.points).parameters,
            LayoutOf(cloud.points, index, three).Over(cloud.points).parameters);
}

}  // namespace batten::internal::rectangle_base_test
