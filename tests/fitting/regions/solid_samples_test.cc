// SPDX-License-Identifier: MIT
#include "fitting/regions/solid_samples.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "batten/fitting/fit_parts.h"
#include "batten/geometry/make_curve.h"
#include "body_clouds.h"
#include "fitting/regions/solid_genus.h"
#include "part_clouds.h"

namespace batten::internal {
namespace {

constexpr int kPoints = 8000;
constexpr double kStep = 0.02;  // a fortieth of the parts and finer than their bores

PartsFit SolidOf(const Eigen::Matrix3Xd& points, double most_invented = 0.15) {
  PartFitOptions options;
  options.solid = options.regularise = true;
  options.most_invented = most_invented;
  options.threads = 2;
  return FitParts(PointCloud::FromWorld(points), options);
}

double VolumeOf(const std::vector<SolidSample>& samples) {
  double volume = 0;
  for (const SolidSample& sample : samples)
    volume += sample.area * sample.place.dot(sample.outward) / 3;
  return volume;
}

TEST(SolidSamplesTest, TheirFluxIsTheVolumeOfTheSolid) {
  for (const TruthPart& part : {BoxPart(), LBlockPart(), TubePart(), FlangePart(), ShaftPart()}) {
    SCOPED_TRACE(part.name);
    const PartsFit fit = SolidOf(SampledPart(part, kPoints, 1e-4, 7).points);
    ASSERT_TRUE(fit.solid) << fit.no_solid;
    // Cells at edges are in or out as a whole: of their random sum a few thousandths remain.
    EXPECT_NEAR(VolumeOf(SampledSolid(*fit.solid, kStep)), part.volume, 0.01 * part.volume);
  }
}

// A square of two straight and two round sides, of a ring a thousand times its area.
TEST(SolidSamplesTest, TheFarSideOfALargeRoundFaceIsNotOfASmallPiece) {
  constexpr double kMajor = 18, kMinor = 2.5, kTurn = 0.1, kTube = 0.8;
  const TorusShape torus{{0, 0, 0}, {0, 0, 1}, kMajor, kMinor};
  const auto place = [](double round, double tube) -> Eigen::Vector3d {
    const double r = kMajor + kMinor * std::cos(tube);
    return {r * std::cos(round), r * std::sin(round), kMinor * std::sin(tube)};
  };
  TrimmedSolid solid;
  solid.vertices.resize(3, 4);
  solid.vertices << place(0, 0), place(kTurn, 0), place(kTurn, kTube), place(0, kTube);
  const Eigen::Vector3d z = Eigen::Vector3d::UnitZ();
  const auto round = [&](double tube) {
    return ExactArc{Frame({0, 0, kMinor * std::sin(tube)}, z, Eigen::Vector3d::UnitX()),
                    kMajor + kMinor * std::cos(tube),
                    {0, kTurn}};
  };
  const auto across = [&](double turn) {
    const Eigen::Vector3d out(std::cos(turn), std::sin(turn), 0);
    return ExactArc{Frame(kMajor * out, out.cross(z), out), kMinor, {0, kTube}};
  };
  const std::vector<ExactArc> arcs{round(0), across(kTurn), round(kTube), across(0)};
  TrimmedSolidFace face{torus, false, {{{0, false}, {1, false}, {2, true}, {3, true}}}};
  const int ends[4][2] = {{0, 1}, {1, 2}, {3, 2}, {0, 3}};
  for (std::size_t k = 0; k < 4; ++k) {
    solid.edges.push_back(
        {MakeArc(arcs[k].frame, arcs[k].radius, arcs[k].angles), arcs[k], ends[k][0], ends[k][1]});
  }
  solid.faces = {face};
  double area = 0;
  for (const SolidSample& sample : SampledSolid(solid, 0.05)) area += sample.area;
  const double truth = kTurn * kMinor * (kMajor * kTube + kMinor * std::sin(kTube));
  // Cells are as coarse as twenty thousand on the whole ring make them: some fifty are inside.
  EXPECT_NEAR(area, truth, 0.2 * truth);
}

TEST(SolidSamplesTest, WhatNoPointShowsIsInvented) {
  const Eigen::Matrix3Xd ball = SpherePoints(kPoints, 0.001);
  for (const double height : {-1.5, -0.9, -0.5, 0.0, 0.5}) {
    SCOPED_TRACE(height);
    std::vector<int> kept;
    for (int k = 0; k < kPoints; ++k) {
      if (ball(2, k) > height) kept.push_back(k);
    }
    const PartsFit fit = SolidOf(ball(Eigen::all, kept), 1);
    ASSERT_TRUE(fit.solid) << fit.no_solid;
    // A cap's share of a sphere, less the ring that points at its rim still show: as wide as twice
    // the distance of a sixth neighbour, that of neighbours at the rim a little more.
    const double cap = std::max(0.0, (1 + height) / 2);
    const double ring = 2 * std::sqrt(6 * 4.0 / kPoints) * 1.5 / 2;
    EXPECT_LE(fit.invented, cap + 0.002);
    EXPECT_GE(fit.invented, cap - ring);
    const PartsFit careful = SolidOf(ball(Eigen::all, kept));
    EXPECT_EQ(careful.solid.has_value(), fit.invented <= 0.15);
    if (!careful.solid) {
      EXPECT_NE(careful.no_solid.find("do not go all round"), std::string::npos);
    }
  }
}

TEST(SolidGenusTest, CountsHandles) {
  const auto genus = [](const TruthPart& part) {
    const PartsFit fit = SolidOf(SampledPart(part, kPoints, 1e-4, 7).points);
    EXPECT_TRUE(fit.solid) << part.name << ": " << fit.no_solid;
    return fit.genus;
  };
  EXPECT_EQ(genus(BoxPart()), 0);
  EXPECT_EQ(genus(TubePart()), 1);
  EXPECT_EQ(genus(FlangePart()), 7);
  EXPECT_EQ(genus(ShaftPart()), 0);
}

TEST(SolidGenusTest, TheHandleOfATorusIsWhereItsLoopsLeaveIt) {
  // Small circles on a torus about the z axis, seen from outside clockwise about their discs: the
  // face beside them is the torus less the discs, or, turned round, a disc.
  const auto loops_of = [](bool discs) {
    TrimmedSolid solid;
    solid.vertices.resize(3, 2);
    TrimmedSolidFace face{TorusShape{{0, 0, 0}, {0, 0, 1}, 2, 0.5}, false, {}};
    for (const double side : {1.0, -1.0}) {
      const Frame frame({side * 2.4, 0, 0}, {side, 0, 0});
      const ExactArc arc{frame, 0.3, {0, 2 * std::numbers::pi}};
      const int number = static_cast<int>(solid.edges.size());
      solid.edges.push_back({MakeArc(arc.frame, arc.radius, arc.angles), arc, number, number});
      solid.vertices.col(number) = solid.edges.back().curve.At(0);
      face.loops.push_back({{number, !discs}});
    }
    solid.faces = {face};
    // Planes stand for what lies beside the circles.
    solid.faces.push_back({PlaneShape{{2.4, 0, 0}, {1, 0, 0}}, false, {face.loops[0]}});
    solid.faces.push_back({PlaneShape{{-2.4, 0, 0}, {1, 0, 0}}, false, {face.loops[1]}});
    return solid;
  };
  EXPECT_EQ(GenusOf(loops_of(false)), 1);
  // Two loops of which neither is in the other make a sphere where they are a face between them.
  EXPECT_EQ(GenusOf(loops_of(true)), 0);
  TrimmedSolid whole;
  whole.faces = {{TorusShape{{0, 0, 0}, {0, 0, 1}, 2, 0.5}, false, {}}};
  EXPECT_EQ(GenusOf(whole), 1);
  whole.faces = {{SphereShape{{0, 0, 0}, 1}, false, {}}};
  EXPECT_EQ(GenusOf(whole), 0);
}

// A box, and beside it one that is scaled and moved along all axes.
PartsFit TwoBoxes(double scale, double move) {
  const Eigen::Matrix3Xd one = SampledPart(BoxPart(), kPoints, 1e-4, 7).points;
  Eigen::Matrix3Xd both(3, 2 * kPoints);
  both << one, (scale * one).colwise() + Eigen::Vector3d::Constant(move);
  return SolidOf(both);
}

TEST(SolidSamplesTest, BodiesApartAreCounted) {
  const PartsFit apart = TwoBoxes(1, 3);
  ASSERT_TRUE(apart.solid) << apart.no_solid;
  EXPECT_EQ(apart.bodies, 2);
}

TEST(SolidSamplesTest, BodiesInOneAnotherAreRefused) {
  const PartsFit nested = TwoBoxes(0.5, 0.1);
  EXPECT_FALSE(nested.solid);
  EXPECT_NE(nested.no_solid.find("2 bodies, of which two lie in one another"), std::string::npos)
      << nested.no_solid;
}

TEST(SolidSamplesTest, BodiesThatCrossAreNoSolid) {
  const Eigen::Matrix3Xd ball = SpherePoints(kPoints, 0.001);
  Eigen::Matrix3Xd both(3, 2 * kPoints);
  both << ball, ball.colwise() + Eigen::Vector3d(1, 0, 0);
  const PartsFit fit = SolidOf(both);
  EXPECT_FALSE(fit.solid);
  EXPECT_NE(fit.no_solid.find("cross one another"), std::string::npos) << fit.no_solid;
}

}  // namespace
}  // namespace batten::internal
