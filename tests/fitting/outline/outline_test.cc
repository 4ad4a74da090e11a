// SPDX-License-Identifier: MIT
#include "batten/fitting/outline.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <random>
#include <set>
#include <stdexcept>
#include <string>

#include "batten/geometry/trim_loops.h"
#include "cases.h"
#include "outline_laws.h"
#include "outlined_clouds.h"

namespace batten::internal::outline_test {

constexpr double kTau = 2 * std::numbers::pi;

int ControlPoints(const Outline& outline) {
  int count = 0;
  for (const OutlineCurve& curve : outline.loops) count += curve.loop.basis().size();
  return count;
}

// Loops in number and order, near the true ones. `smooth` and `corner` in spacings. The area is
// right to 0.6 %, or of small clouds to a fifth of a spacing along the border: where a border lies
// between the points and beyond is not known better.
void ExpectOutline(const OutlinedShape& shape,
                   int count,
                   Scatter scatter,
                   unsigned seed,
                   double smooth,
                   double corner) {
  SCOPED_TRACE(Told(shape, count, scatter, seed));
  const OutlinedCloud cloud = CloudIn(shape, count, scatter, seed, 0.0);
  ThreadPool pool(2);
  const OutlineOptions options = OptionsFor(cloud);
  const Outline outline = FindOutline(cloud.points, options, pool);
  ASSERT_FALSE(outline.fills);
  ASSERT_EQ(outline.loops.size(), shape.loops.size());
  EXPECT_EQ(outline.parts, 1);
  ExpectSound(outline, options, cloud.points);
  const std::vector<Places> polygons = PolygonsOf(outline);
  const OutlineMisfit misfit = MisfitOf(cloud.shape, polygons);
  EXPECT_LE(misfit.smooth, smooth);
  EXPECT_LE(misfit.corner, corner);
  const double area = cloud.shape.Area();
  EXPECT_NEAR(
      TotalArea(polygons), area, std::max(0.006 * area, 0.2 * PerimeterOf(cloud.shape.loops)));
}

std::vector<OutlinedShape> Shapes() {
  return {
      DiscShape(), RingShape(), LShape(), StarShape(), CrescentShape(), PlateShape(), WavyShape()};
}

// Scan lines are √3 spacings apart.
double SmoothFor(Scatter scatter) { return scatter == Scatter::kScanLines ? std::sqrt(3.0) : 1.0; }

// Of borders some hundred spacings long every random gap counts: 1.14 is met once in 63 clouds.
TEST(FindOutlineTest, IsNearTheTrueOutline) {
  for (const OutlinedShape& shape : Shapes())
    for (const Scatter scatter :
         {Scatter::kRandom, Scatter::kJittered, Scatter::kGrid, Scatter::kScanLines})
      for (unsigned seed = 1; seed <= 3; ++seed)
        ExpectOutline(shape, 2000, scatter, seed, 1.15 * SmoothFor(scatter), 3);
}

TEST(LongFindOutlineTest, IsNearTheTrueOutlineOfLargeClouds) {
  for (const OutlinedShape& shape : Shapes())
    for (const Scatter scatter :
         {Scatter::kRandom, Scatter::kJittered, Scatter::kGrid, Scatter::kScanLines})
      for (const int count : {20000, 100000})
        for (unsigned seed = 1; seed <= 3; ++seed)
          ExpectOutline(shape, count, scatter, seed, SmoothFor(scatter), 3);
}

TEST(LongFindOutlineTest, IsNearTheTrueOutlineOfAMillionPoints) {
  for (const OutlinedShape& shape : {DiscShape(), LShape(), PlateShape()})
    ExpectOutline(shape, 1000000, Scatter::kRandom, 1, 1, 3);
}

void ExpectFilled(int count, Scatter scatter, unsigned seed, double pad) {
  SCOPED_TRACE(Told(RectangleShape(), count, scatter, seed));
  const OutlinedCloud cloud = CloudIn(RectangleShape(), count, scatter, seed, pad);
  ThreadPool pool(2);
  const Outline outline = FindOutline(cloud.points, OptionsFor(cloud), pool);
  EXPECT_TRUE(outline.fills);
  EXPECT_TRUE(outline.loops.empty());
  EXPECT_TRUE(outline.warnings.empty());
}

TEST(FindOutlineTest, FindsNothingToTrimInRectangles) {
  for (const Scatter scatter :
       {Scatter::kRandom, Scatter::kJittered, Scatter::kGrid, Scatter::kScanLines})
    for (const double pad : {0.0, 0.5})
      for (unsigned seed = 1; seed <= 3; ++seed) {
        ExpectFilled(2000, scatter, seed, pad);
        ExpectFilled(20000, scatter, seed, pad);
      }
}

TEST(LongFindOutlineTest, FindsNothingToTrimInLargeRectangles) {
  for (const Scatter scatter :
       {Scatter::kRandom, Scatter::kJittered, Scatter::kGrid, Scatter::kScanLines})
    for (unsigned seed = 1; seed <= 5; ++seed) {
      ExpectFilled(100000, scatter, seed, 0.5);
      ExpectFilled(1000000, scatter, seed, 0.5);
    }
}

TEST(FindOutlineTest, RoundOutlinesTakeFewControlPoints) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const OutlinedCloud cloud = CloudIn(DiscShape(), 7854, Scatter::kRandom, seed);  // radius 50
    ThreadPool pool(1);
    const Outline outline = FindOutline(cloud.points, OptionsFor(cloud), pool);
    EXPECT_LE(ControlPoints(outline), 24);
    EXPECT_TRUE(outline.loops[0].corners.empty());
  }
}

OutlinedShape DiscWithHole(double share) {
  OutlinedShape shape = DiscShape();
  shape.loops.push_back(EllipseLoop(0.6, 0.55, share, share));
  return shape;
}

// A hole of eight spacings across is one; three missing points are chance.
TEST(FindOutlineTest, TellsHolesFromChance) {
  constexpr int kCount = 20000;
  const double spacing = std::sqrt(DiscShape().Area() / kCount);
  for (unsigned seed = 1; seed <= 5; ++seed) {
    ExpectOutline(DiscWithHole(4 * spacing), kCount, Scatter::kJittered, seed, 1.2, 0);
    OutlinedCloud cloud = CloudIn(DiscShape(), kCount, Scatter::kGrid, seed);
    const Eigen::Index third = cloud.points.cols() / 3;
    cloud.points.middleCols(third, 3) = cloud.points.middleCols(0, 3);
    ThreadPool pool(1);
    EXPECT_EQ(FindOutline(cloud.points, OptionsFor(cloud), pool).loops.size(), 1);
  }
}

TEST(FindOutlineTest, EveryPartHasItsOutline) {
  OutlinedCloud large = CloudIn(DiscShape(), 3000, Scatter::kRandom, 1),
                small = CloudIn(LShape(), 1000, Scatter::kRandom, 2);
  Eigen::Matrix2Xd points(2, 4000);
  points << large.points, (small.points.array() + 80).matrix();
  OutlineOptions options = OptionsFor(large);
  options.length_u = options.length_v = 120;
  ThreadPool pool(1);
  const Outline outline = FindOutline(points, options, pool);
  EXPECT_EQ(outline.parts, 2);
  ASSERT_EQ(outline.loops.size(), 2);
  ExpectSound(outline, options, points);
  EXPECT_NEAR(AreaOf(PolygonAlong(outline.loops[0].loop)), 3000, 60);
  EXPECT_NEAR(AreaOf(PolygonAlong(outline.loops[1].loop)), 1000, 35);
  EXPECT_EQ(outline.warnings.size(), 1);  // the parts
}

// --- Ragged clouds of several parts.

// Discs, strips and lines of points anywhere, one over the other, much of them left out: borders
// as ragged as depth cameras make them, parts that nearly touch, and points by themselves.
Eigen::Matrix2Xd RaggedCloud(unsigned seed, double side) {
  std::mt19937_64 engine(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  const auto at = [&] { return side * uniform(engine); };
  std::vector<std::function<bool(const Eigen::Vector2d&)>> shapes;
  for (int k = 0; k < 12; ++k) {
    const Eigen::Vector2d centre(at(), at());
    const double radius = 2 + 0.15 * at(), angle = std::numbers::pi * uniform(engine);
    const Eigen::Vector2d way(std::cos(angle), std::sin(angle));
    const double width = uniform(engine) < 0.5 ? radius : 1 + uniform(engine);
    shapes.push_back([=](const Eigen::Vector2d& p) {
      const Eigen::Vector2d from = p - centre;
      return std::abs(from.dot(way)) < 2 * radius &&
             std::abs(from.x() * way.y() - from.y() * way.x()) < width;
    });
  }
  const double kept = 0.5 + 0.5 * uniform(engine);
  Places points;
  for (double x = 0.5; x < side; ++x)
    for (double y = 0.5; y < side; ++y) {
      const Eigen::Vector2d p(x + 0.6 * (uniform(engine) - 0.5), y + 0.6 * (uniform(engine) - 0.5));
      const bool in =
          std::any_of(shapes.begin(), shapes.end(), [&](const auto& shape) { return shape(p); });
      if (in && uniform(engine) < kept) points.push_back(p);
    }
  for (int k = 0; k < 5; ++k) points.emplace_back(at(), at());
  Eigen::Matrix2Xd cloud(2, static_cast<Eigen::Index>(points.size()));
  for (size_t k = 0; k < points.size(); ++k) cloud.col(static_cast<Eigen::Index>(k)) = points[k];
  return cloud;
}

// The rectangle as a plane, trimmed by the loops.
NurbsSurface TrimmedRectangle(const Outline& outline, const OutlineOptions& options) {
  const double u = options.length_u, v = options.length_v;
  Eigen::Matrix3Xd corners(3, 4);
  corners << 0, 0, u, u, 0, v, 0, v, 0, 0, 0, 0;
  std::vector<NurbsCurve<2>> loops;
  for (const OutlineCurve& curve : outline.loops) loops.push_back(curve.loop);
  return NurbsSurface(SplineBasis(1, {0, 0, u, u}), SplineBasis(1, {0, 0, v, v}), corners)
      .WithTrims(std::move(loops));
}

// Loops that bound regions, no point farther than three spacings from them, and those outside told.
void ExpectAllWithin(unsigned seed, double side) {
  SCOPED_TRACE("seed " + std::to_string(seed));
  const Eigen::Matrix2Xd points = RaggedCloud(seed, side);
  OutlineOptions options;
  options.spacing = 1;
  options.length_u = options.length_v = side;
  ThreadPool pool(2);
  const Outline outline = FindOutline(points, options, pool);
  if (outline.fills) return;
  const NurbsSurface trimmed = TrimmedRectangle(outline, options);
  EXPECT_NO_THROW(CheckTrims(trimmed));
  EXPECT_EQ(LoopsByRegion(trimmed).size(), outline.parts);
  EXPECT_FALSE(outline.loops.empty());
  for (const OutlineCurve& curve : outline.loops) ExpectEverySpanLong(curve.loop);
  const std::vector<Places> polygons = PolygonsOf(outline);
  const std::set<Eigen::Index> outside(outline.outside.begin(), outline.outside.end());
  for (Eigen::Index k = 0; k < points.cols(); ++k) {
    double away = std::numeric_limits<double>::infinity();
    for (const Places& polygon : polygons)
      away = std::min(away, DistanceTo(polygon, points.col(k)));
    const bool beyond = PointsBeyond(polygons, points.col(k)) > 0;
    if (beyond) {
      EXPECT_LE(away, 3.01) << points.col(k).transpose();
    }
    if (away > 0.02) {  // nearer, the polygons do not say
      EXPECT_EQ(beyond, outside.contains(k)) << points.col(k).transpose();
    }
  }
}

TEST(FindOutlineTest, RaggedPartsNeverCrossAndHideNoPoint) {
  for (int seed = 1; seed <= Cases(12); ++seed) ExpectAllWithin(static_cast<unsigned>(seed), 60);
  // Samples on vertices of the border; a part that a lone point joins.
  for (const unsigned seed : {3u, 88u, 179u}) ExpectAllWithin(seed, 80);
}

TEST(LongFindOutlineTest, ManyRaggedPartsNeverCrossAndHideNoPoint) {
  for (unsigned seed = 1; seed <= 300; ++seed) ExpectAllWithin(seed, seed % 10 == 0 ? 200 : 80);
}

// --- Laws of scaling, turning and order.

// A map that runs off beyond the tip of a wedge of points: the outline's corner is not where it
// takes it far from all of them.
TEST(FindOutlineTest, ReachesNoFartherBeyondThePointsInSpaceThanACornerMay) {
  for (unsigned seed = 0; seed < 8; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> along(0, 60), across(-1, 1);
    Eigen::Matrix2Xd points(2, 2000);
    double tip = 0;
    for (auto p : points.colwise()) {
      const double u = 60 - std::sqrt(60 * along(random));
      p = Eigen::Vector2d(2 + u, 40 + across(random) * (60 - u) / 2);
      tip = std::max(tip, p[0]);
    }
    OutlineOptions options{.spacing = 1, .length_u = 80, .length_v = 80};
    options.place = [&](const Eigen::Vector2d& at) {
      const double off = std::max(0.0, at[0] - tip);
      return Eigen::Vector3d(at[0], at[1], 10 * off * off);
    };
    ThreadPool pool(2);
    const Outline outline = FindOutline(points, options, pool);
    double highest = 0;
    for (const Places& polygon : PolygonsOf(outline))
      for (const Eigen::Vector2d& place : polygon)
        highest = std::max(highest, options.place(place)[2]);
    EXPECT_LT(highest, 8);
  }
}

// A map that runs off beside a part, towards a point far from it: spacings in space are as large as
// they like there, and the part's outline is what it is without that point.
TEST(FindOutlineTest, AMapThatRunsOffBesideAPartLeavesItsOutlineAsItIs) {
  for (unsigned seed = 0; seed < 8; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> at(-1, 1);
    Eigen::Matrix2Xd points(2, 1600);
    for (Eigen::Index k = 0; k < points.cols();) {
      const Eigen::Vector2d p(at(random), at(random));
      if (p.norm() < 1) points.col(k++) = Eigen::Vector2d(40, 40) + 23 * p;
    }
    OutlineOptions options{.spacing = 1, .length_u = 100, .length_v = 80};
    options.place = [](const Eigen::Vector2d& p) {
      return Eigen::Vector3d(p[0], p[1], 1e3 * std::max(0.0, p[0] - 70));
    };
    ThreadPool pool(2);
    const Outline alone = FindOutline(points, options, pool);
    Eigen::Matrix2Xd more(2, points.cols() + 1);
    more << points, Eigen::Vector2d(90, 40);
    const Outline beside = FindOutline(more, options, pool);
    EXPECT_EQ(beside.outside, alone.outside);
    ASSERT_EQ(beside.loops.size(), 2U);
    EXPECT_EQ(beside.loops[0].loop.control_points(), alone.loops[0].loop.control_points());
  }
}

TEST(FindOutlineTest, ScalesWithTheUnit) {
  const OutlinedCloud cloud = CloudIn(PlateShape(), 5000, Scatter::kRandom, 3);
  ThreadPool pool(1);
  const Outline plain = FindOutline(cloud.points, OptionsFor(cloud), pool);
  for (const double unit : {1e-6, 1e6}) {
    OutlineOptions options = OptionsFor(cloud);
    options.spacing *= unit;
    options.length_u *= unit;
    options.length_v *= unit;
    const Outline scaled = FindOutline(cloud.points * unit, options, pool);
    ASSERT_EQ(scaled.loops.size(), plain.loops.size());
    for (size_t k = 0; k < plain.loops.size(); ++k) {
      const auto &a = plain.loops[k].loop.control_points(),
                 b = scaled.loops[k].loop.control_points();
      ASSERT_EQ(a.cols(), b.cols());
      EXPECT_LE((a - b / unit).cwiseAbs().maxCoeff(), 1e-5);  // in spacings: steps that stop early
    }
  }
}

TEST(FindOutlineTest, TurnsWithTheCloud) {
  const OutlinedCloud cloud = CloudIn(StarShape(), 5000, Scatter::kRandom, 4, 30.0);
  ThreadPool pool(1);
  const Outline plain = FindOutline(cloud.points, OptionsFor(cloud), pool);
  const Eigen::Vector2d middle(cloud.length_u / 2, cloud.length_v / 2);
  for (const double angle : {0.3, 1.7, 4.0}) {
    Eigen::Matrix2d turn;
    turn << std::cos(angle), -std::sin(angle), std::sin(angle), std::cos(angle);
    const Eigen::Matrix2Xd points = (turn * (cloud.points.colwise() - middle)).colwise() + middle;
    const Outline turned = FindOutline(points, OptionsFor(cloud), pool);
    ASSERT_EQ(turned.loops.size(), plain.loops.size());
    EXPECT_EQ(turned.loops[0].corners.size(), plain.loops[0].corners.size());
    Places back = PolygonAlong(turned.loops[0].loop);
    for (Eigen::Vector2d& p : back) p = turn.transpose() * (p - middle) + middle;
    OutlinedShape as_shape{"turned", {PolygonAlong(plain.loops[0].loop)}, {}};
    for (const double corner : plain.loops[0].corners)
      as_shape.corners.push_back(plain.loops[0].loop.At(corner));
    // Samples along the ragged border begin elsewhere, so corners are found a little beside, and
    // the sides between them; each is within one of the truth.
    const OutlineMisfit misfit = MisfitOf(as_shape, {back});
    EXPECT_LE(misfit.smooth, 1);
    EXPECT_LE(misfit.corner, 1.5);
  }
}

TEST(FindOutlineTest, IsTheSameForAnyThreadsAndOrder) {
  const OutlinedCloud cloud = CloudIn(PlateShape(), 20000, Scatter::kRandom, 5);
  ThreadPool one(1), three(3);
  const Outline plain = FindOutline(cloud.points, OptionsFor(cloud), one);
  const Outline threads = FindOutline(cloud.points, OptionsFor(cloud), three);
  const Outline reversed = FindOutline(cloud.points.rowwise().reverse(), OptionsFor(cloud), one);
  ASSERT_EQ(threads.loops.size(), plain.loops.size());
  ASSERT_EQ(reversed.loops.size(), plain.loops.size());
  for (size_t k = 0; k < plain.loops.size(); ++k) {
    EXPECT_EQ(threads.loops[k].loop, plain.loops[k].loop);
    const auto &a = plain.loops[k].loop.control_points(),
               &b = reversed.loops[k].loop.control_points();
    ASSERT_EQ(a.cols(), b.cols());
    EXPECT_LE((a - b).cwiseAbs().maxCoeff(), 1e-6);
  }
}

// --- Round directions.

constexpr double kRound = 200, kTall = 100;

template <typename Inside>
Eigen::Matrix2Xd OnCylinder(unsigned seed, const Inside& inside) {
  std::mt19937_64 engine(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  Places places;
  for (int i = 0; i < kRound * kTall; ++i) {
    const double u = kRound * uniform(engine), v = kTall * uniform(engine);
    if (inside(u, v)) places.emplace_back(u, v);
  }
  Eigen::Matrix2Xd points(2, static_cast<Eigen::Index>(places.size()));
  for (size_t k = 0; k < places.size(); ++k) points.col(static_cast<Eigen::Index>(k)) = places[k];
  return points;
}

OutlineOptions RoundOptions(bool both = false) {
  OutlineOptions options;
  options.spacing = 1;
  options.length_u = kRound;
  options.length_v = kTall;
  options.periodic_u = true;
  options.periodic_v = both;
  return options;
}

double Apart(double a, double b, double period) { return std::abs(std::remainder(a - b, period)); }

double Rim(double u) { return 80 + 8 * std::sin(2 * kTau * u / kRound); }

TEST(FindOutlineTest, TubesAndToriAndSpheresFill) {
  const auto all = [](double, double) { return true; };
  ThreadPool pool(1);
  for (unsigned seed = 1; seed <= 5; ++seed) {
    EXPECT_TRUE(FindOutline(OnCylinder(seed, all), RoundOptions(), pool).fills);
    EXPECT_TRUE(FindOutline(OnCylinder(seed, all), RoundOptions(true), pool).fills);
  }
}

TEST(FindOutlineTest, ARaggedTubeHasOneLoopAlongTheSeam) {
  ThreadPool pool(1);
  for (unsigned seed = 1; seed <= 5; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const auto hole = [](double u, double v) {
      return std::hypot(Apart(u, 5, kRound), v - 40) < 20;
    };
    const Eigen::Matrix2Xd points =
        OnCylinder(seed, [&](double u, double v) { return v < Rim(u) && !hole(u, v); });
    const Outline outline = FindOutline(points, RoundOptions(), pool);
    ASSERT_EQ(outline.loops.size(), 1);
    ExpectSound(outline, RoundOptions(), points);
    const Places loop = PolygonAlong(outline.loops[0].loop);
    EXPECT_NEAR(AreaOf(loop), 80 * kRound - 400 * std::numbers::pi, 100);
    int on_seams = 0;
    for (const Eigen::Vector2d& p : loop) {
      const bool seam = p.x() == 0 || p.x() == kRound;
      on_seams += seam;
      const double off = std::min({std::abs(p.y() - Rim(p.x())),
                                   p.y(),
                                   std::abs(std::hypot(Apart(p.x(), 5, kRound), p.y() - 40) - 20)});
      EXPECT_TRUE(seam || off <= 1) << p.transpose();
    }
    EXPECT_GT(on_seams, 20);
    // Both sides of the seam end at the same heights.
    for (const double corner : outline.loops[0].corners) {
      const Eigen::Vector2d p = outline.loops[0].loop.At(corner);
      if (p.x() != 0) continue;
      double nearest = 1;
      for (const double other : outline.loops[0].corners) {
        const Eigen::Vector2d q = outline.loops[0].loop.At(other);
        if (q.x() == kRound) nearest = std::min(nearest, std::abs(p.y() - q.y()));
      }
      EXPECT_LE(nearest, 1e-9);
    }
  }
}

TEST(FindOutlineTest, HolesInTubesAndToriKeepTheRectangle) {
  ThreadPool pool(1);
  for (const bool both : {false, true}) {
    const Eigen::Matrix2Xd points =
        OnCylinder(7, [](double u, double v) { return std::hypot(u - 100, v - 50) > 15; });
    const Outline outline = FindOutline(points, RoundOptions(both), pool);
    ASSERT_EQ(outline.loops.size(), 2);
    EXPECT_EQ(outline.loops[0].loop.basis().degree(), 1);
    EXPECT_EQ(outline.loops[0].loop.basis().size(), 5);
    ExpectSound(outline, RoundOptions(both), points);
    for (const Eigen::Vector2d& p : PolygonAlong(outline.loops[1].loop))
      EXPECT_NEAR((p - Eigen::Vector2d(100, 50)).norm(), 15, 1);
  }
}

TEST(FindOutlineTest, AHoleWhereBothSeamsMeetIsCutInFour) {
  ThreadPool pool(1);
  const Eigen::Matrix2Xd points = OnCylinder(8, [](double u, double v) {
    return std::hypot(Apart(u, 0, kRound), Apart(v, 0, kTall)) > 15;
  });
  const Outline outline = FindOutline(points, RoundOptions(true), pool);
  ASSERT_EQ(outline.loops.size(), 1);
  ExpectSound(outline, RoundOptions(true), points);
  EXPECT_EQ(outline.loops[0].corners.size(), 8);
  EXPECT_NEAR(
      AreaOf(PolygonAlong(outline.loops[0].loop)), kRound * kTall - 225 * std::numbers::pi, 20);
}

constexpr double kRadius = 50;

Eigen::Matrix2Xd OnSphere(unsigned seed, double lowest) {
  std::mt19937_64 engine(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  Places places;
  for (int i = 0; i < 2 * kTau * kRadius * kRadius; ++i) {
    const double v = kRadius * std::acos(2 * uniform(engine) - 1),
                 u = kTau * kRadius * uniform(engine);
    if (v < lowest) places.emplace_back(u, v);
  }
  Eigen::Matrix2Xd points(2, static_cast<Eigen::Index>(places.size()));
  for (size_t k = 0; k < places.size(); ++k) points.col(static_cast<Eigen::Index>(k)) = places[k];
  return points;
}

TEST(FindOutlineTest, PolesAreNoHoles) {
  OutlineOptions options;
  options.spacing = 1;
  options.periodic_u = options.pole_start = options.pole_end = true;
  options.length_u = kTau * kRadius;
  options.length_v = std::numbers::pi * kRadius;
  options.stretch_u = [](double v) { return std::sin(v / kRadius); };
  ThreadPool pool(1);
  for (unsigned seed = 1; seed <= 5; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    EXPECT_TRUE(FindOutline(OnSphere(seed, 1e9), options, pool).fills);
    const Eigen::Matrix2Xd bowl = OnSphere(seed, 110);
    const Outline outline = FindOutline(bowl, options, pool);
    ASSERT_EQ(outline.loops.size(), 1);
    ExpectSound(outline, options, bowl);
    for (const Eigen::Vector2d& p : PolygonAlong(outline.loops[0].loop))
      EXPECT_LE(std::min({p.y(), std::abs(p.y() - 110), p.x(), std::abs(p.x() - options.length_u)}),
                1);
  }
}

// --- Little, odd and broken input.

TEST(FindOutlineTest, PointsWithoutAreaHaveNoOutline) {
  OutlineOptions options;
  options.spacing = 1;
  options.length_u = options.length_v = 100;
  ThreadPool pool(1);
  for (const int count : {1, 2, 3, 50}) {
    Eigen::Matrix2Xd points = Eigen::Matrix2Xd::Constant(2, count, 10.0);
    for (int line = 0; line < 2; ++line) {
      const Outline outline = FindOutline(points, options, pool);
      EXPECT_TRUE(outline.loops.empty());
      EXPECT_EQ(outline.warnings.size(), 1);
      for (int k = 0; k < count; ++k) points(0, k) += k;
    }
  }
}

TEST(FindOutlineTest, DuplicatesChangeNothing) {
  const OutlinedCloud cloud = CloudIn(LShape(), 3000, Scatter::kRandom, 6);
  Eigen::Matrix2Xd twice(2, 6000);
  twice << cloud.points, cloud.points;
  ThreadPool pool(1);
  const Outline a = FindOutline(cloud.points, OptionsFor(cloud), pool),
                b = FindOutline(twice, OptionsFor(cloud), pool);
  ASSERT_EQ(a.loops.size(), b.loops.size());
  EXPECT_EQ(a.loops[0].loop, b.loops[0].loop);
}

TEST(FindOutlineTest, NamesWhatIsWrong) {
  ThreadPool pool(1);
  const Eigen::Matrix2Xd points = Eigen::Matrix2Xd::Zero(2, 3);
  OutlineOptions options;
  EXPECT_THROW(FindOutline(points, options, pool), std::invalid_argument);
  options.spacing = 1;
  options.length_v = 0;
  EXPECT_THROW(FindOutline(points, options, pool), std::invalid_argument);
  options.length_v = 1;
  options.noise = -1;
  EXPECT_THROW(FindOutline(points, options, pool), std::invalid_argument);
  options.noise = 0;
  EXPECT_THROW(FindOutline(Eigen::Matrix2Xd(2, 0), options, pool), std::invalid_argument);
}

}  // namespace batten::internal::outline_test
