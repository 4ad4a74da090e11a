// SPDX-License-Identifier: MIT
#include "fitting/flattening/poisson_disk_samples.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "bent_sheets.h"
#include "fitting/flattening/sheet_graph.h"
#include "fitting/flattening/voronoi_weights.h"
#include "tolerances.h"

namespace batten::internal::poisson_disk_samples_test {

PoissonDiskSamples NodesOf(const Eigen::Matrix3Xd& points,
                           double noise = 0,
                           const PoissonDiskOptions& options = {}) {
  ThreadPool pool(2);
  return SamplePoissonDisk(points, NeighbourIndex(points), noise, options, pool);
}

TEST(SamplePoissonDiskTest, KeepsNodesTheirReachApartAndEveryPointNearOne) {
  for (unsigned seed = 1; seed <= 3; ++seed) {
    for (const double density : {1.0, 10.0}) {
      SCOPED_TRACE("seed " + std::to_string(seed) + ", density " + std::to_string(density));
      const Eigen::Matrix3Xd points =
          PointsOn(FlatSheet(), {.count = 6000, .density = density, .seed = seed}).points;
      const PoissonDiskSamples nodes = NodesOf(points);
      for (Eigen::Index i = 0; i < nodes.size(); ++i) {
        for (Eigen::Index j = 0; j < i; ++j) {
          EXPECT_GE((nodes.places.col(i) - nodes.places.col(j)).norm(),
                    (1 - kIterated) * std::min(nodes.reach[i], nodes.reach[j]));
        }
      }
      for (const auto p : points.colwise()) {
        const Eigen::ArrayXd apart = (nodes.places.colwise() - p).colwise().norm();
        EXPECT_LE((apart / nodes.reach.array()).minCoeff(), 1 + kIterated);
      }
    }
  }
}

TEST(SamplePoissonDiskTest, TakesAboutAsManyAsAsked) {
  const Eigen::Matrix3Xd points = PointsOn(ArcSheet(200), {.count = 50000}).points;
  for (const Eigen::Index most : {200, 800, 2000}) {
    const Eigen::Index count = NodesOf(points, 0, {.most = most}).size();
    EXPECT_GE(count, 0.7 * static_cast<double>(most));
    EXPECT_LE(count, 1.2 * static_cast<double>(most));
  }
}

TEST(SamplePoissonDiskTest, TakesAllOfFewPoints) {
  EXPECT_EQ(NodesOf(PointsOn(ArcSheet(90), {.count = 150}).points).size(), 150);
}

TEST(SamplePoissonDiskTest, StaysFourTimesTheNoiseApart) {
  const PoissonDiskSamples nodes =
      NodesOf(PointsOn(FlatSheet(), {.count = 10000, .sigma = 0.02}).points, 0.02);
  EXPECT_GE(nodes.reach.minCoeff(), 0.08);
}

// Of a cylinder of radius 1: the curvature along is 1 and across 0.
TEST(SamplePoissonDiskTest, KnowsPlaceNormalAndCurvature) {
  const PoissonDiskSamples nodes = NodesOf(PointsOn(ArcSheet(180), {.count = 20000}).points);
  for (Eigen::Index i = 0; i < nodes.size(); ++i) {
    const Eigen::Vector2d radial = nodes.places.col(i).head<2>();
    EXPECT_NEAR(radial.norm(), 1, 1e-4);
    EXPECT_NEAR(std::abs(nodes.normals.col(i).head<2>().dot(radial.normalized())), 1, 1e-3);
    EXPECT_NEAR(nodes.normals.col(i).norm(), 1, kRounding);
    EXPECT_NEAR(nodes.normals.col(i).dot(nodes.tangents.col(i)), 0, kRounding);
    const Eigen::Vector3d k = nodes.curvature.col(i);
    EXPECT_NEAR(std::abs(k[0] + k[2]), 1, 0.1);
    EXPECT_NEAR(k[0] * k[2] - k[1] * k[1], 0, 0.1);
  }
}

TEST(PoissonDiskSamplesTest, FlippingTurnsTheHeightOver) {
  PoissonDiskSamples nodes = NodesOf(PointsOn(ShellSheet(), {.count = 2000}).points);
  const PoissonDiskSamples before = nodes;
  nodes.Flip(7);
  // The same quadric: x stays, y and the height change their signs.
  EXPECT_EQ(nodes.Binormal(7), -before.Binormal(7));
  const Eigen::Vector3d k = before.curvature.col(7);
  EXPECT_EQ(nodes.curvature.col(7), Eigen::Vector3d(-k[0], k[1], -k[2]));
}

TEST(ConnectSheetTest, AgreesOnOneSideAndJoinsNeighboursOnly) {
  for (const BentSheet& sheet : {ShellSheet(), Roll(), SBend(), SphericalCap(120)}) {
    SCOPED_TRACE(sheet.name);
    const SheetPoints cloud = PointsOn(sheet, {.count = 8000, .sigma = 1e-3});
    const SheetGraph graph = ConnectSheet(NodesOf(cloud.points, 1e-3), {});
    EXPECT_EQ(graph.share, 1);
    EXPECT_TRUE(graph.contradictions.empty());
    const PoissonDiskSamples& nodes = graph.nodes;
    for (const auto& [i, j] : graph.edges) {
      EXPECT_LT(i, j);
      EXPECT_GT(nodes.normals.col(i).dot(nodes.normals.col(j)), 0);
      EXPECT_LE((nodes.places.col(i) - nodes.places.col(j)).norm(),
                2.6 * std::min(nodes.reach[i], nodes.reach[j]));
    }
  }
}

TEST(ConnectSheetTest, FindsTheContradictionOfAMoebiusBand) {
  const SheetPoints cloud = PointsOn(TwistedBand(1), {.count = 6000});
  EXPECT_FALSE(ConnectSheet(NodesOf(cloud.points), {}).contradictions.empty());
  const SheetPoints two_sided = PointsOn(TwistedBand(2), {.count = 6000});
  EXPECT_TRUE(ConnectSheet(NodesOf(two_sided.points), {}).contradictions.empty());
}

// Σ w q = 0 around every node that is not at the edge of the sheet.
TEST(VoronoiEdgeWeightsTest, AreExactForLinearFunctionsInTheInterior) {
  for (unsigned seed = 1; seed <= 3; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const SheetGraph graph =
        ConnectSheet(NodesOf(PointsOn(FlatSheet(), {.count = 8000, .seed = seed}).points), {});
    const PoissonDiskSamples& nodes = graph.nodes;
    Eigen::Matrix3Xd sum = Eigen::Matrix3Xd::Zero(3, nodes.size());
    for (const auto& [i, j, weight] : VoronoiEdgeWeights(graph)) {
      EXPECT_GT(weight, 0);
      const Eigen::Vector3d way = weight * (nodes.places.col(j) - nodes.places.col(i));
      sum.col(i) += way;
      sum.col(j) -= way;
    }
    int inner = 0, exact = 0;
    for (Eigen::Index i = 0; i < nodes.size(); ++i) {
      const Eigen::Vector3d p = nodes.places.col(i);
      if (std::min({p[0], 1 - p[0], p[1], 1 - p[1]}) < 3 * nodes.reach[i]) continue;
      ++inner;
      // Every edge of the graph has a thousandth of weight of its own; cells end at gaps of more
      // than 1.7 reaches.
      if (sum.col(i).norm() < 0.02 * nodes.reach[i]) ++exact;
    }
    EXPECT_GT(inner, 300);
    EXPECT_GE(exact, 0.97 * inner);
  }
}

TEST(VoronoiEdgeWeightsTest, CoverTheSheetOnce) {
  const SheetGraph graph =
      ConnectSheet(NodesOf(PointsOn(ArcSheet(180, 3), {.count = 20000}).points), {});
  double area = 0;
  for (const auto& [i, j, weight] : VoronoiEdgeWeights(graph)) {
    area += weight / 2 * (graph.nodes.places.col(j) - graph.nodes.places.col(i)).squaredNorm();
  }
  // Cells at the edge reach over it by about half a node's reach, 0.045 of 3.
  EXPECT_NEAR(area / (3 * std::numbers::pi), 1, 0.06);
}

}  // namespace batten::internal::poisson_disk_samples_test
