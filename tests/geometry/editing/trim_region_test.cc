// SPDX-License-Identifier: MIT
#include "batten/geometry/trim_region.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include "angles.h"
#include "batten/geometry/degree_elevation.h"
#include "batten/geometry/insert_knots.h"
#include "batten/geometry/reparameterize.h"
#include "batten/geometry/reverse.h"
#include "batten/geometry/surface_area.h"
#include "tolerances.h"
#include "trim_cases.h"

namespace batten::internal::trim_region_test {

using Cover = TrimRegion::Cover;
NurbsSurface Plane(double u0 = 0, double u1 = 1, double v0 = 0, double v1 = 1) {
  const SplineBasis u = SplineBasis::Uniform(1, 2, u0, u1), v = SplineBasis::Uniform(1, 2, v0, v1);
  Eigen::Matrix3Xd points(3, 4);
  points << u0, u0, u1, u1, v0, v1, v0, v1, 0, 0, 0, 0;
  return NurbsSurface(u, v, points);
}

// Places at random, and places as near to the loops as rounding allows to tell.
void ExpectInside(const NurbsSurface& surface,
                  const std::function<bool(double, double)>& inside,
                  int count,
                  unsigned seed) {
  const TrimRegion region(surface);
  RandomSplines random(seed);
  for (int k = 0; k < count; ++k) {
    const double u = random.Real(surface.basis_u().lower(), surface.basis_u().upper());
    const double v = random.Real(surface.basis_v().lower(), surface.basis_v().upper());
    ASSERT_EQ(region.Contains(u, v), inside(u, v)) << u << ' ' << v << ", seed " << seed;
  }
}

void ExpectDisc(int count) {
  ExpectInside(
      Plane().WithTrims({Circle({0.5, 0.5}, 0.4)}),
      [](double u, double v) { return (u - 0.5) * (u - 0.5) + (v - 0.5) * (v - 0.5) <= 0.4 * 0.4; },
      count,
      1);
}

TEST(TrimRegionTest, OfADiscIsTheDisc) { ExpectDisc(100000); }
TEST(LongTrimRegionTest, OfADiscIsTheDisc) { ExpectDisc(20000000); }

TEST(TrimRegionTest, WithoutTrimsIsEverything) {
  const TrimRegion region{Plane()};
  EXPECT_TRUE(region.Contains(0.3, 0.4));
  EXPECT_TRUE(region.Contains(-3, 0.4));
  EXPECT_EQ(region.CoverOf({0, 1, 0, 1}), Cover::kInside);
  EXPECT_THROW(region.Contains(std::numeric_limits<double>::quiet_NaN(), 0), std::invalid_argument);
}

// Points of the curve itself are inside, and those half a millionth of a millionth beyond; twice
// as far they are not.
TEST(TrimRegionTest, TheBoundaryCountsAsInside) {
  for (const unsigned seed : {1u, 2u}) {
    for (const LoopCase& loops : LoopCases(seed)) {
      SCOPED_TRACE(loops.name + ", seed " + std::to_string(seed));
      const NurbsSurface surface = Trimmed(Plane(-3, 5, 100, 101), loops);
      const TrimRegion region(surface);
      for (const NurbsCurve<2>& loop : surface.trims()) {
        for (int k = 0; k <= 2000; ++k) {
          const double s =
              loop.basis().lower() + (loop.basis().upper() - loop.basis().lower()) * k / 2000;
          const Eigen::Vector2d at = loop.At(s);
          ASSERT_TRUE(region.Contains(at[0], at[1])) << s;
        }
      }
    }
  }
  const TrimRegion disc(Plane().WithTrims({Circle({0.5, 0.5}, 0.4)}));
  for (int k = 0; k < 10000; ++k) {
    const double a = 2 * kPi * k / 10000, c = std::cos(a), s = std::sin(a);
    const auto contains = [&](double r) { return disc.Contains(0.5 + r * c, 0.5 + r * s); };
    EXPECT_TRUE(contains(0.4 - 1e-11));
    EXPECT_TRUE(contains(0.4 + 5e-13));
    EXPECT_FALSE(contains(0.4 + 3e-12));
  }
}

// The polygon of a loop, crossed by a ray: an independent count, wrong only between the loop and
// the polygon.
TEST(TrimRegionTest, AgreesWithAPolygonOfManyCorners) {
  constexpr double kChord = 1e-7;
  for (const unsigned seed : {1u, 2u, 3u}) {
    for (const LoopCase& loops : LoopCases(seed)) {
      SCOPED_TRACE(loops.name + ", seed " + std::to_string(seed));
      const NurbsSurface surface = Trimmed(Plane(), loops);
      const TrimRegion region(surface);
      RandomSplines random(seed);
      std::vector<Polygon> polygons;
      for (const NurbsCurve<2>& loop : surface.trims()) {
        polygons.push_back(LoopPolyline(loop, kChord));
      }
      for (int k = 0; k < 500; ++k) {
        const double u = random.Real(0, 1), v = random.Real(0, 1);
        bool inside = false;
        double nearest = 1;
        for (const Polygon& polygon : polygons) {
          const Eigen::Index count = polygon.points.cols();
          for (Eigen::Index i = 0; i < count; ++i) {
            const Eigen::Vector2d a = polygon.points.col(i),
                                  b = polygon.points.col((i + 1) % count);
            if ((a[1] <= v) == (b[1] <= v)) continue;
            const double x = a[0] + (v - a[1]) / (b[1] - a[1]) * (b[0] - a[0]);
            nearest = std::min(nearest, std::abs(x - u));
            if (x > u) inside = !inside;
          }
        }
        if (nearest <= 1e-4) continue;
        ASSERT_EQ(region.Contains(u, v), inside) << u << ' ' << v;
      }
    }
  }
}

// The region depends on the loops' shapes alone, not on degree, knots, parameters or direction.
TEST(TrimRegionTest, EditsOfALoopChangeNothing) {
  for (const LoopCase& loops : LoopCases(8)) {
    SCOPED_TRACE(loops.name);
    const NurbsSurface surface = Trimmed(Plane(5e6, 5e6 + 1, -1e-6, 1e-6), loops);
    const TrimRegion region(surface);
    std::vector<NurbsCurve<2>> elevated, refined, reversed;
    for (const NurbsCurve<2>& loop : surface.trims()) {
      const double middle = (loop.basis().lower() + loop.basis().upper()) / 2 + 1e-3;
      elevated.push_back(Elevated(loop, kMaxDegree - loop.basis().degree()));
      refined.push_back(InsertKnot(loop, middle, loop.basis().degree()));
      reversed.push_back(Reversed(Reparameterized(loop, 1e4, 1e4 + 1)));
    }
    for (const auto& edited : {elevated, refined, reversed}) {
      const TrimRegion other(surface.WithTrims(edited));
      RandomSplines random(8);
      for (int k = 0; k < 2000; ++k) {
        const double u = random.Real(5e6, 5e6 + 1), v = random.Real(-1e-6, 1e-6);
        if (region.CoverOf({u - 1e-7, u + 1e-7, v - 1e-13, v + 1e-13}) == Cover::kCut) continue;
        ASSERT_EQ(region.Contains(u, v), other.Contains(u, v)) << u << ' ' << v;
      }
    }
  }
}

// Pieces of no length, cusps and a loop far smaller than the domain.
TEST(TrimRegionTest, DegenerateLoopsAreFollowed) {
  const auto expect =
      [](const NurbsCurve<2>& loop, const Eigen::Vector2d& in, const Eigen::Vector2d& out) {
        const TrimRegion region(Plane().WithTrims({loop}));
        EXPECT_TRUE(region.Contains(in[0], in[1]));
        EXPECT_FALSE(region.Contains(out[0], out[1]));
      };
  expect(PolygonLoop({{0.1, 0.1}, {0.1, 0.1}, {0.9, 0.1}, {0.9, 0.9}, {0.9, 0.9}}),
         {0.7, 0.5},
         {0.4, 0.5});
  // A triangle whose sides are cubics with all speed lost at the corners.
  Eigen::Matrix2Xd points(2, 10);
  points << 0.1, 0.1, 0.9, 0.9, 0.9, 0.5, 0.5, 0.5, 0.1, 0.1,  //
      0.1, 0.1, 0.1, 0.1, 0.1, 0.9, 0.9, 0.9, 0.1, 0.1;
  const SplineBasis basis(3, {0, 0, 0, 0, 1, 1, 1, 2, 2, 2, 3, 3, 3, 3});
  expect(NurbsCurve<2>(basis, points), {0.5, 0.5}, {0.2, 0.5});
  expect(Circle({0.3, 0.3}, 1e-8), {0.3, 0.3 + 0.9e-8}, {0.3, 0.3 + 1.1e-8});
}

TEST(TrimRegionTest, CoverIsCertainWhereItSaysSo) {
  for (const LoopCase& loops : LoopCases(5)) {
    SCOPED_TRACE(loops.name);
    const TrimRegion region(Trimmed(Plane(), loops));
    RandomSplines random(5);
    int cut = 0;
    for (int k = 0; k < 2000; ++k) {
      const double u = random.Real(0, 1), v = random.Real(0, 1);
      const double a = u + random.Logarithmic(1e-4, 0.3), b = v + random.Logarithmic(1e-4, 0.3);
      const Cover cover = region.CoverOf({u, a, v, b});
      if (cover == Cover::kCut) {
        ++cut;
        continue;
      }
      for (int i = 0; i < 20; ++i) {
        const double x = i < 4 ? (i % 2 == 0 ? u : a) : random.Real(u, a);
        const double y = i < 4 ? (i / 2 == 0 ? v : b) : random.Real(v, b);
        ASSERT_EQ(region.Contains(x, y), cover == Cover::kInside);
      }
    }
    EXPECT_LT(cut, 1000);  // boxes are small against the loops
  }
}

// A loop along the domain's sides does not cut the boxes there.
TEST(TrimRegionTest, BoxesAtTheDomainsSideAreInside) {
  const TrimRegion region(Trimmed(Plane(), {RectangleLoop(0, 1, 0, 1), Circle({0.5, 0.5}, 0.1)}));
  EXPECT_EQ(region.CoverOf({0, 0.2, 0, 0.2}), Cover::kInside);
  EXPECT_EQ(region.CoverOf({0.8, 1, 0.3, 0.6}), Cover::kInside);
  EXPECT_EQ(region.CoverOf({0.49, 0.51, 0.49, 0.51}), Cover::kOutside);
  EXPECT_EQ(region.CoverOf({0.3, 0.7, 0.3, 0.7}), Cover::kCut);
}

// Points between the arms of a double spiral of Archimedes, as polygons.
TEST(TrimRegionTest, SpiralsAreFollowed) {
  constexpr int kCount = 4000;
  constexpr double kTurns = 6, kStep = 0.4 / (kTurns * 2 * kPi), kWidth = 0.45;
  std::vector<Eigen::Vector2d> corners;
  const auto at = [](double angle, double shift) {
    const double r = 0.02 + kStep * (angle + shift);
    return Eigen::Vector2d(0.5 + r * std::cos(angle), 0.5 + r * std::sin(angle));
  };
  for (int k = 0; k <= kCount; ++k) corners.push_back(at(kTurns * 2 * kPi * k / kCount, 0));
  for (int k = kCount; k >= 0; --k) {
    corners.push_back(at(kTurns * 2 * kPi * k / kCount, kWidth * 2 * kPi));
  }
  const NurbsSurface surface = Trimmed(Plane(), {PolygonLoop(corners)});
  ASSERT_NO_THROW(CheckTrims(surface));
  const TrimRegion region(surface);
  RandomSplines random(3);
  for (int k = 0; k < 50000; ++k) {
    const double angle = random.Real(0.1, kTurns * 2 * kPi - 0.1), shift = random.Real(-0.4, 0.95);
    if (std::abs(shift) < 0.01 || std::abs(shift - kWidth) < 0.01) continue;
    const Eigen::Vector2d place = at(angle, shift * 2 * kPi);
    // Shifts beyond the band lie between this turn and the next, or beyond the last.
    ASSERT_EQ(region.Contains(place[0], place[1]), shift > 0 && shift < kWidth)
        << angle << ' ' << shift;
  }
}

TEST(TrimRegionTest, ManyHolesAreAllFound) {
  std::vector<NurbsCurve<2>> loops{RectangleLoop(0, 1, 0, 1)};
  constexpr int kSide = 30;
  const auto centre = [](int i) { return (i + 0.5) / kSide; };
  for (int i = 0; i < kSide; ++i) {
    for (int j = 0; j < kSide; ++j) loops.push_back(Circle({centre(i), centre(j)}, 0.4 / kSide));
  }
  const NurbsSurface surface = Trimmed(Plane(), loops);
  CheckTrims(surface);
  ExpectInside(
      surface,
      [&](double u, double v) {
        const int i = static_cast<int>(u * kSide), j = static_cast<int>(v * kSide);
        return std::hypot(u - centre(i), v - centre(j)) >= 0.4 / kSide;
      },
      100000,
      2);
}

// Places at the very heights of corners, extremes and knots.
TEST(TrimRegionTest, RaysThroughCornersCountOnce) {
  const TrimRegion diamond(
      Trimmed(Plane(), {PolygonLoop({{0.5, 0.1}, {0.9, 0.5}, {0.5, 0.9}, {0.1, 0.5}})}));
  const TrimRegion disc(Trimmed(Plane(), {Circle({0.5, 0.5}, 0.4)}));
  for (const TrimRegion* region : {&diamond, &disc}) {
    for (int k = 0; k <= 100; ++k) {
      const double x = k / 100.0;
      EXPECT_EQ(region->Contains(x, 0.5), x >= 0.1 && x <= 0.9) << x;
      EXPECT_EQ(region->Contains(0.5, x), x >= 0.1 && x <= 0.9) << x;
      EXPECT_EQ(region->Contains(x, 0.1), k == 50) << x;
      EXPECT_EQ(region->Contains(x, 0.9), k == 50) << x;
    }
  }
}

TEST(TrimRegionTest, ASeamBelongsToBothSides) {
  // Periodic in u over [0, 6]; the part touches the seam from above only.
  std::vector<double> knots;
  for (int k = -2; k <= 8; ++k) knots.push_back(k);
  const SplineBasis u = SplineBasis::Periodic(2, knots), v = SplineBasis::Uniform(1, 2, 0, 1);
  Eigen::Matrix3Xd points(3, u.size() * 2);
  for (int i = 0; i < u.size(); ++i) {
    const double a = 2 * kPi * (i % 6) / 6;
    points.col(2 * i) << std::cos(a), std::sin(a), 0;
    points.col(2 * i + 1) << std::cos(a), std::sin(a), 1;
  }
  const NurbsSurface tube(u, v, points);
  const TrimRegion part(tube.WithTrims({RectangleLoop(0, 2, 0.2, 0.8)}));
  EXPECT_TRUE(part.Contains(6, 0.5));
  EXPECT_TRUE(part.Contains(12, 0.5));
  EXPECT_TRUE(part.Contains(7, 0.5));
  EXPECT_FALSE(part.Contains(5.9, 0.5));
  EXPECT_FALSE(part.Contains(6, 0.9));
  EXPECT_EQ(part.CoverOf({5, 5.9, 0.3, 0.7}), Cover::kOutside);
  EXPECT_NE(part.CoverOf({5, 6, 0.3, 0.7}), Cover::kOutside);
  EXPECT_EQ(part.CoverOf({6.5, 7.5, 0.3, 0.7}), Cover::kInside);
  EXPECT_EQ(part.CoverOf({5, 7, 0.3, 0.7}), Cover::kCut);
  const TrimRegion band(tube.WithTrims({RectangleLoop(0, 6, 0.2, 0.8)}));
  EXPECT_EQ(band.CoverOf({0, 1, 0.3, 0.7}), Cover::kInside);
  EXPECT_EQ(band.CoverOf({5, 6, 0.3, 0.7}), Cover::kInside);
  EXPECT_TRUE(band.Contains(0, 0.5));
}

TEST(SignedAreaTest, IsTheFormulaAndTurnsWithTheLoop) {
  EXPECT_NEAR(SignedArea(Circle({1e5, 7}, 0.4)) / (0.16 * kPi), 1, kIterated);
  EXPECT_NEAR(SignedArea(Circle({3, 7}, 0.4)), 0.16 * kPi, kRounding);
  EXPECT_NEAR(SignedArea(Circle({3, 7}, 0.4, false)), -0.16 * kPi, kRounding);
  EXPECT_NEAR(SignedArea(RectangleLoop(1, 3, 0, 5)), 10, kRounding);
}

TEST(SignedAreaTest, OfRandomLoopsIsThatOfTheirPolygons) {
  for (const unsigned seed : {1u, 2u, 3u}) {
    RandomSplines random(seed);
    for (const bool rational : {false, true}) {
      const NurbsCurve<2> loop = WavyLoop(random, {0.5, 0.5}, 0.4, 8, rational);
      const Eigen::Matrix2Xd p = LoopPolyline(loop, 1e-9).points;
      double twice = 0;
      for (Eigen::Index k = 0; k < p.cols(); ++k) {
        const Eigen::Index next = (k + 1) % p.cols();
        twice += p(0, k) * p(1, next) - p(1, k) * p(0, next);
      }
      EXPECT_NEAR(SignedArea(loop), twice / 2, 4e-9) << seed;  // the length times the chord error
    }
  }
}

TEST(TurnedLoopsTest, PutsTheOuterLoopFirstAndTurnsAll) {
  const std::vector<NurbsCurve<2>> loops = TurnedLoops(
      {Circle({0.3, 0.5}, 0.1), Circle({0.5, 0.5}, 0.4, false), Circle({0.7, 0.5}, 0.05, false)});
  ASSERT_EQ(loops.size(), 3u);
  EXPECT_NEAR(SignedArea(loops[0]), 0.16 * kPi, kRounding);
  EXPECT_NEAR(SignedArea(loops[1]), -0.01 * kPi, kRounding);
  EXPECT_NEAR(SignedArea(loops[2]), -0.0025 * kPi, kRounding);
  EXPECT_TRUE(TurnedLoops({}).empty());
}

TEST(LoopPolylineTest, KeepsTheToleranceAndTheLoop) {
  for (const LoopCase& loops : LoopCases(6)) {
    for (const NurbsCurve<2>& loop : loops.loops) {
      for (const double tolerance : {1e-2, 1e-4}) {
        const Polygon polygon = LoopPolyline(loop, tolerance);
        const Eigen::Index count = polygon.points.cols();
        for (Eigen::Index k = 0; k < count; ++k) {
          const double s0 = polygon.parameters[k];
          const double s1 = k + 1 < count ? polygon.parameters[k + 1] : loop.basis().upper();
          ASSERT_LT(s0, s1);
          ASSERT_LE((loop.At(s0) - polygon.points.col(k)).norm(), kRounding);
          const Eigen::Vector2d a = polygon.points.col(k);
          const Eigen::Vector2d chord = polygon.points.col((k + 1) % count) - a;
          for (int i = 1; i < 8; ++i) {
            const Eigen::Vector2d reach = loop.At(s0 + (s1 - s0) * i / 8) - a;
            const double t = std::clamp(reach.dot(chord) / chord.squaredNorm(), 0.0, 1.0);
            ASSERT_LE((reach - t * chord).norm(), tolerance + kRounding);
          }
        }
      }
    }
  }
  EXPECT_THROW(LoopPolyline(Circle({0, 0}, 1), 0), std::invalid_argument);
}

std::string Complaint(const NurbsSurface& surface) {
  try {
    CheckTrims(surface);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(CheckTrimsTest, NamesTheLoopAndTheRule) {
  const NurbsSurface plane = Plane();
  const NurbsCurve<2> disc = Circle({0.5, 0.5}, 0.4);
  const auto complaint = [&](std::vector<NurbsCurve<2>> loops) {
    return Complaint(plane.WithTrims(std::move(loops)));
  };
  const auto expect = [](const std::string& text, const std::string& part) {
    EXPECT_NE(text.find(part), std::string::npos) << text;
  };
  EXPECT_EQ(complaint({disc, Circle({0.5, 0.5}, 0.1, false)}), "");
  expect(complaint({Circle({0.5, 0.5}, 0.4, false)}),
         "loop 0 (an outer one) is not turned counter");
  expect(complaint({disc, Circle({0.5, 0.5}, 0.1)}),
         "loop 0 (an outer one) and trim loop 1 (an outer one) overlap");
  expect(complaint({Circle({0.5, 0.5}, 0.6)}), "loop 0 (an outer one) leaves the domain");
  expect(complaint({disc, Circle({0.5, 0.8}, 0.2, false)}), "loop 1 (a hole)");
  expect(complaint({disc, Circle({0.05, 0.05}, 0.04, false)}), "reaches beyond the outer loop");
  expect(complaint({disc, Circle({0.5, 0.5}, 0.1, false), Circle({0.5, 0.5}, 0.05, false)}),
         "1 (a hole) and trim loop 2 (a hole) overlap");
  expect(complaint({disc, Circle({0.5, 0.5}, 0.1, false), Circle({0.6, 0.5}, 0.1, false)}),
         "1 (a hole) and trim loop 2 (a hole)");
  expect(complaint({PolygonLoop({{0.1, 0.1}, {0.9, 0.9}, {0.9, 0.1}, {0.1, 0.8}})}), "loop 0");
  expect(complaint({PolygonLoop({{0.1, 0.1}, {0.9, 0.1}, {0.5, 0.1}})}), "bounds no area");
}

// Their loops in any order, but for the first.
TEST(LoopsByRegionTest, AreOuterLoopsWithTheirHoles) {
  std::vector<NurbsCurve<2>> loops = LoopsOfThreeRegions();
  std::rotate(loops.begin() + 1, loops.begin() + 3, loops.end());  // holes before outer loops
  const NurbsSurface surface = Plane().WithTrims(loops);
  EXPECT_EQ(Complaint(surface), "");
  std::vector<double> areas;
  std::vector<size_t> sizes;
  for (const auto& region : LoopsByRegion(surface)) {
    EXPECT_EQ(Complaint(Plane().WithTrims(region)), "");
    areas.push_back(Area(Plane().WithTrims(region)));
    sizes.push_back(region.size());
  }
  EXPECT_THAT(sizes, testing::ElementsAre(2, 2, 1));
  EXPECT_THAT(areas,
              testing::ElementsAre(testing::DoubleNear((0.04 - 0.01) * kPi, 1e-9),
                                   testing::DoubleNear((0.28 * 0.28 - 0.18 * 0.18) * kPi, 1e-9),
                                   testing::DoubleNear(0.14 * 0.08, 1e-9)));
  EXPECT_TRUE(LoopsByRegion(Plane()).empty());
}

TEST(CheckTrimsTest, RegionsLieBesideOneAnotherOrInHoles) {
  const NurbsSurface plane = Plane();
  const auto complaint = [&](std::vector<NurbsCurve<2>> loops) {
    return Complaint(plane.WithTrims(std::move(loops)));
  };
  const NurbsCurve<2> left = Circle({0.25, 0.5}, 0.2), right = Circle({0.75, 0.5}, 0.2);
  EXPECT_EQ(complaint({left, right}), "");
  EXPECT_EQ(complaint({left, Circle({0.65, 0.5}, 0.2)}), "");  // they touch
  EXPECT_EQ(complaint({left, right, Circle({0.75, 0.5}, 0.1, false)}), "");
  EXPECT_EQ(complaint({left, Circle({0.25, 0.5}, 0.1, false), Circle({0.25, 0.5}, 0.05)}), "");
  EXPECT_NE(complaint({left, Circle({0.55, 0.5}, 0.2)}), "");
  EXPECT_NE(complaint({left, Circle({0.5, 0.8}, 0.05, false)}), "");  // a hole in neither
  EXPECT_NE(complaint({left, right, Circle({0.5, 0.5}, 0.1, false)}), "");
}

TEST(CheckTrimsTest, LoopsMayTouch) {
  const NurbsSurface plane = Plane();
  EXPECT_EQ(Complaint(plane.WithTrims({Circle({0.5, 0.5}, 0.4), Circle({0.8, 0.5}, 0.1, false)})),
            "");
  EXPECT_EQ(Complaint(plane.WithTrims({Circle({0.5, 0.5}, 0.4),
                                       Circle({0.4, 0.5}, 0.05, false),
                                       Circle({0.5, 0.5}, 0.05, false)})),
            "");
}

// Depths of a crossing from far above the resolution to near it.
TEST(CheckTrimsTest, FindsShallowCrossings) {
  const NurbsSurface plane = Plane();
  for (const double depth : {1e-1, 1e-3, 1e-5, 1e-7}) {
    for (const double angle : {0.0, 0.3, 1.2, 2.9, 4.4}) {
      const Eigen::Vector2d centre(0.5 + (0.3 + depth) * std::cos(angle),
                                   0.5 + (0.3 + depth) * std::sin(angle));
      EXPECT_NE(Complaint(plane.WithTrims({Circle({0.5, 0.5}, 0.4), Circle(centre, 0.1, false)})),
                "")
          << depth << ' ' << angle;
    }
  }
}

}  // namespace batten::internal::trim_region_test
