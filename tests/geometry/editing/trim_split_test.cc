// SPDX-License-Identifier: MIT
// Pieces of trimmed surfaces: what counted in the whole counts in the pieces.
#include <gtest/gtest.h>

#include <stdexcept>
#include <string>
#include <vector>

#include "batten/geometry/make_surface.h"
#include "batten/geometry/split.h"
#include "tolerances.h"
#include "trim_cases.h"

namespace batten::internal::trim_split_test {

NurbsSurface UnitPlane() { return MakeBilinear({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}); }

// 3 × 4 spans, degree (2, 3), a domain that is not the unit square.
NurbsSurface Sheet(RandomSplines& random) {
  const SplineBasis u = SplineBasis::Uniform(2, 5, -1, 5), v = SplineBasis::Uniform(3, 7, 10, 11);
  Eigen::Matrix3Xd points(3, u.size() * v.size());
  for (int i = 0; i < u.size(); ++i) {
    for (int j = 0; j < v.size(); ++j) {
      points.col(i * v.size() + j) << u.Greville(i), v.Greville(j), random.Real(-1, 1);
    }
  }
  return NurbsSurface(u, v, points);
}

bool InDomainOf(const NurbsSurface& piece, double u, double v) {
  return u > piece.basis_u().lower() && u < piece.basis_u().upper() &&
         v > piece.basis_v().lower() && v < piece.basis_v().upper();
}

// Every place of the box counts in as many pieces as it should: one where it counts in the whole.
void ExpectPartition(const NurbsSurface& whole,
                     const std::vector<NurbsSurface>& pieces,
                     const ParameterBox& box,
                     RandomSplines& random) {
  const TrimRegion region(whole);
  std::vector<TrimRegion> regions;
  for (const NurbsSurface& piece : pieces) {
    ASSERT_NO_THROW(CheckTrims(piece));
    regions.emplace_back(piece);
  }
  for (int k = 0; k < 1000; ++k) {
    const double u = random.Real(box.u0, box.u1), v = random.Real(box.v0, box.v1);
    if (NearLoop(region, whole, u, v)) continue;
    int found = 0;
    for (size_t i = 0; i < pieces.size(); ++i) {
      if (!InDomainOf(pieces[i], u, v) || !regions[i].Contains(u, v)) continue;
      ++found;
      ASSERT_LE((pieces[i].At(u, v) - whole.At(u, v)).norm(), kIterated);
    }
    ASSERT_EQ(found, region.Contains(u, v) ? 1 : 0) << u << ' ' << v;
  }
}

double PartArea(const NurbsSurface& surface) {
  if (!surface.trimmed()) {
    return (surface.basis_u().upper() - surface.basis_u().lower()) *
           (surface.basis_v().upper() - surface.basis_v().lower());
  }
  double area = 0;
  for (const NurbsCurve<2>& loop : surface.trims()) area += SignedArea(loop);
  return area;
}

TEST(TrimSplitTest, PartsMakeUpTheWhole) {
  for (const unsigned seed : {1u, 2u, 3u, 4u}) {
    for (const LoopCase& loops : LoopCases(seed)) {
      RandomSplines random(seed);
      const NurbsSurface whole = Trimmed(Sheet(random), loops);
      for (const Direction direction : {Direction::kU, Direction::kV}) {
        const SplineBasis& basis = direction == Direction::kU ? whole.basis_u() : whole.basis_v();
        const double at = random.Real(basis.lower(), basis.upper());
        SCOPED_TRACE(loops.name + ", seed " + std::to_string(seed) + ", cut at " +
                     std::to_string(at));
        std::vector<NurbsSurface> pieces = SegmentParts(whole, direction, basis.lower(), at);
        for (NurbsSurface& piece : SegmentParts(whole, direction, at, basis.upper())) {
          pieces.push_back(std::move(piece));
        }
        ExpectPartition(whole, pieces, {-1, 5, 10, 11}, random);
        double area = 0;
        for (const NurbsSurface& piece : pieces) area += PartArea(piece);
        EXPECT_NEAR(area, PartArea(whole), kIterated);
      }
    }
  }
}

TEST(TrimSplitTest, DecomposeGivesEveryPartItsPiece) {
  for (const LoopCase& loops : LoopCases(7)) {
    SCOPED_TRACE(loops.name);
    RandomSplines random(7);
    const NurbsSurface whole = Trimmed(Sheet(random), loops);
    const std::vector<NurbsSurface> pieces = Decompose(whole);
    ExpectPartition(whole, pieces, {-1, 5, 10, 11}, random);
    for (const NurbsSurface& piece : pieces) {
      EXPECT_EQ(piece.basis_u().Spans().size() * piece.basis_v().Spans().size(), 1u);
      EXPECT_GT(PartArea(piece), 0);
    }
  }
}

TEST(TrimSplitTest, PiecesThatTheLoopsFillAreNotTrimmed) {
  const NurbsSurface holed =
      Trimmed(UnitPlane(), {RectangleLoop(0, 1, 0, 1), Circle({0.25, 0.5}, 0.1)});
  const auto [low, high] = Split(holed, Direction::kU, 0.5);
  EXPECT_EQ(low.trims().size(), 2u);
  EXPECT_FALSE(high.trimmed());
}

TEST(TrimSplitTest, ACutThroughAHoleOpensIt) {
  const NurbsSurface ring =
      Trimmed(UnitPlane(), {Circle({0.5, 0.5}, 0.4), Circle({0.5, 0.5}, 0.2)});
  const auto [low, high] = Split(ring, Direction::kV, 0.5);
  for (const NurbsSurface& half : {low, high}) {
    EXPECT_EQ(half.trims().size(), 1u);
    EXPECT_NEAR(PartArea(half), std::numbers::pi * (0.16 - 0.04) / 2, kRounding);
  }
}

TEST(TrimSplitTest, ALoopAlongTheCutIsCutThere) {
  const NurbsSurface plane = UnitPlane();
  const NurbsSurface holed =
      Trimmed(plane, {RectangleLoop(0, 1, 0, 1), RectangleLoop(0.3, 0.5, 0.2, 0.6)});
  for (const double at : {0.3, 0.5}) {
    RandomSplines random(1);
    const auto [low, high] = Split(holed, Direction::kU, at);
    ExpectPartition(holed, {low, high}, {0, 1, 0, 1}, random);
    EXPECT_NEAR(PartArea(low) + PartArea(high), 1 - 0.08, kRounding);
  }
  const NurbsSurface part = Trimmed(plane, {RectangleLoop(0.3, 0.5, 0.2, 0.6)});
  EXPECT_NEAR(PartArea(Segment(part, Direction::kU, 0.3, 1)), 0.08, kRounding);
  EXPECT_THROW(Segment(part, Direction::kU, 0.5, 1), std::invalid_argument);
  EXPECT_TRUE(SegmentParts(part, Direction::kU, 0.5, 1).empty());
  EXPECT_FALSE(Segment(part, 0.3, 0.5, 0.2, 0.6).trimmed());
}

TEST(TrimSplitTest, ACutThatTouchesACurveLeavesIt) {
  const NurbsSurface disc = Trimmed(UnitPlane(), {Circle({0.5, 0.5}, 0.25)});
  EXPECT_NEAR(PartArea(Segment(disc, Direction::kU, 0.25, 1)), std::numbers::pi / 16, kRounding);
  EXPECT_TRUE(SegmentParts(disc, Direction::kU, 0, 0.25).empty());
  const NurbsSurface holed =
      Trimmed(UnitPlane(), {RectangleLoop(0, 1, 0, 1), Circle({0.5, 0.5}, 0.25)});
  RandomSplines random(1);
  const auto [low, high] = Split(holed, Direction::kU, 0.75);
  ExpectPartition(holed, {low, high}, {0, 1, 0, 1}, random);
}

TEST(TrimSplitTest, SeveralPartsAreAllGivenOrRefused) {
  const LoopCase comb = LoopCases(1)[4];
  ASSERT_EQ(comb.name, "comb");
  const NurbsSurface surface = Trimmed(UnitPlane(), comb);
  EXPECT_EQ(SegmentParts(surface, Direction::kV, 0.5, 1).size(), 3u);
  EXPECT_EQ(SegmentParts(surface, Direction::kV, 0.85, 1).size(), 2u);
  EXPECT_EQ(SegmentParts(surface, Direction::kV, 0, 0.2).size(), 1u);
  EXPECT_THROW(Split(surface, Direction::kV, 0.5), std::invalid_argument);
  EXPECT_THROW(Segment(surface, Direction::kV, 0.95, 1), std::invalid_argument);
}

TEST(TrimSplitTest, CutsOfACircleAreArcsOfIt) {
  const NurbsSurface disc = Trimmed(UnitPlane(), {Circle({0.5, 0.5}, 0.4)});
  const NurbsSurface cap = Segment(disc, Direction::kU, 0.7, 1);
  const NurbsCurve<2>& loop = cap.trims()[0];
  for (int k = 0; k <= 200; ++k) {
    const double s = loop.basis().lower() + k * (loop.basis().upper() - loop.basis().lower()) / 200;
    const Eigen::Vector2d at = loop.At(s);
    const double off_circle = std::abs((at - Eigen::Vector2d(0.5, 0.5)).norm() - 0.4);
    EXPECT_LE(std::min(off_circle, std::abs(at[0] - 0.7)), kRounding);
  }
  const double half_angle = std::acos(0.5);
  EXPECT_NEAR(PartArea(cap), 0.16 * (half_angle - std::sin(2 * half_angle) / 2), kRounding);
}

}  // namespace batten::internal::trim_split_test
