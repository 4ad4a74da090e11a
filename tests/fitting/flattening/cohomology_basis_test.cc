// SPDX-License-Identifier: MIT
#include "fitting/flattening/cohomology_basis.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <map>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "tubes.h"

namespace batten::internal::cohomology_basis_test {

constexpr double kFilled = 10;

struct Laid {
  SheetGraph graph;
  std::vector<PlanarEdge> edges;
};

Laid Connected(const BentSheet& sheet, unsigned seed) {
  const SheetPoints cloud = PointsOn(sheet, {.count = 12000, .seed = seed});
  ThreadPool pool(2);
  const NeighbourIndex index(cloud.points);
  Laid laid{ConnectSheet(SamplePoissonDisk(cloud.points, index, 0, {}, pool), {}), {}};
  laid.edges = PlanarEdges(laid.graph);
  return laid;
}

std::vector<SheetLoop> Loops(const Laid& laid, int most = 20) {
  return CohomologyBasis(laid.graph.nodes, laid.edges, kFilled, most);
}

BentSheet WithHoles(BentSheet sheet, int count, double radius) {
  sheet.inside = [=](double u, double v) {
    return std::hypot(std::fmod(count * u, 1) - 0.5, v - 0.5) > radius;
  };
  return sheet;
}

TEST(CohomologyBasisTest, CountsTheWaysRound) {
  for (unsigned seed = 1; seed <= 3; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    EXPECT_EQ(Loops(Connected(FlatSheet(2, 1), seed)).size(), 0);
    EXPECT_EQ(Loops(Connected(SphericalCap(180), seed)).size(), 0);
    EXPECT_EQ(Loops(Connected(RingShaped(FlatSheet(1, 1)), seed)).size(), 1);
    EXPECT_EQ(Loops(Connected(StraightTube(5), seed)).size(), 1);
    EXPECT_EQ(Loops(Connected(TorusSheet(), seed)).size(), 2);
    EXPECT_EQ(Loops(Connected(WithHoles(StraightTube(6), 3, 0.25), seed)).size(), 4);
    EXPECT_EQ(Loops(Connected(WithHoles(FlatSheet(3, 1), 3, 0.25), seed)).size(), 3);
  }
}

// Every way along edges is one round the tube, or none: Σ of the true angle's steps tells.
TEST(CohomologyBasisTest, CrossingsAreThoseOfTheAngleUpToTheNodes) {
  for (const BentSheet& sheet : {StraightTube(5), Elbow(200), WithHoles(StraightTube(6), 3, 0.2)}) {
    SCOPED_TRACE(sheet.name);
    const Laid laid = Connected(sheet, 4);
    const std::vector<SheetLoop> loops = Loops(laid);
    ASSERT_FALSE(loops.empty());
    // Narrowest way round: the inner side of the bend has no shorter one.
    EXPECT_GE(loops[0].length, 0.95 * 2 * std::numbers::pi);
    EXPECT_LE(loops[0].length, 1.2 * 2 * std::numbers::pi);
    const bool bent = sheet.name != "straight tube";
    const auto angle = [&](int i) {
      const Eigen::Vector3d p = laid.graph.nodes.places.col(i);
      return bent ? std::atan2(p[2], std::hypot(p[0], p[1]) - 2.5) : std::atan2(p[1], p[0]);
    };
    // Both count the same class: over any closed way the sums agree up to one sign. It is enough
    // that crossings minus the jumps of the angle are differences of a function on the nodes.
    bool same = false;
    for (const int sign : {1, -1}) {
      std::vector<std::vector<std::pair<int, int>>> next(
          static_cast<size_t>(laid.graph.nodes.size()));
      for (size_t k = 0; k < laid.edges.size(); ++k) {
        const PlanarEdge& e = laid.edges[k];
        const double step = (angle(e.second) - angle(e.first)) / (2 * std::numbers::pi);
        const int off = loops[0].crossings[k] - sign * static_cast<int>(std::lround(step));
        next[e.first].emplace_back(e.second, off);
        next[e.second].emplace_back(e.first, -off);
      }
      std::map<int, int> level{{0, 0}};
      std::vector<int> front{0};
      int contradictions = 0;
      while (!front.empty()) {
        const int i = front.back();
        front.pop_back();
        for (const auto& [j, off] : next[i]) {
          const auto [known, fresh] = level.try_emplace(j, level[i] + off);
          if (fresh) front.push_back(j);
          if (known->second != level[i] + off) ++contradictions;
        }
      }
      same = same || contradictions == 0;
    }
    EXPECT_TRUE(same);
  }
}

TEST(CohomologyBasisTest, StopsAtTheMostLoopsAskedFor) {
  const Laid laid = Connected(WithHoles(StraightTube(6), 3, 0.25), 1);
  EXPECT_EQ(Loops(laid, 2).size(), 2);
}

}  // namespace batten::internal::cohomology_basis_test
