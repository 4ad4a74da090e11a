// SPDX-License-Identifier: MIT
#include "batten/geometry/intersect_surfaces.h"

#include <gtest/gtest.h>
#include <Eigen/Dense>

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include "batten/geometry/arc_length.h"
#include "batten/geometry/foot_point.h"
#include "batten/geometry/make_curve.h"
#include "batten/geometry/make_surface.h"
#include "batten/geometry/trim_region.h"
#include "nasty_surfaces.h"
#include "random_splines.h"
#include "tolerances.h"

namespace batten::internal::intersect_surfaces_test {

constexpr double kPi = std::numbers::pi;

NurbsSurface Placed(const NurbsSurface& surface,
                    const Eigen::Matrix3d& turn,
                    const Eigen::Vector3d& shift) {
  return WithPoints(surface, (turn * surface.control_points()).colwise() + shift);
}

// The three curves of every branch agree between samples, and places lie in the domains.
void ExpectSound(const NurbsSurface& a, const NurbsSurface& b, const SurfaceIntersection& met) {
  for (const SurfaceBranch& branch : met.branches) {
    EXPECT_LE(branch.deviation, met.tolerance);
    for (const bool first : {true, false}) {
      const NurbsSurface& surface = first ? a : b;
      for (const NurbsCurve<2>& part : first ? branch.on_first : branch.on_second) {
        const double from = part.basis().lower(), to = part.basis().upper();
        constexpr int kPlaces = 997;
        for (int k = 0; k <= kPlaces; ++k) {
          const double t = from + k * (to - from) / kPlaces;
          const Eigen::Vector2d at = part.At(t);
          ASSERT_LE((surface.At(at[0], at[1]) - branch.curve.At(t)).norm(), met.tolerance) << t;
        }
      }
    }
  }
}

// Wherever one surface changes the side of the other between neighbours of a dense grid, the place
// is found by halving, and a branch must pass through it. Distances are certified foot points:
// nothing of what is tested. Places whose feet lie on a border, or jump, are not judged. Returns
// how many are.
class SideJudge {
 public:
  SideJudge(const NurbsSurface& a, const NurbsSurface& b, const SurfaceIntersection& met)
      : a_(a), b_(b), on_b_(b), tolerance_(met.tolerance) {
    for (const SurfaceBranch& branch : met.branches) feet_.emplace_back(branch.curve);
  }

  int Judge(int lines) {
    const SplineBasis &U = a_.basis_u(), &V = a_.basis_v();
    std::vector<Sample> samples;
    for (int i = 0; i <= lines; ++i) {
      for (int j = 0; j <= lines; ++j) {
        samples.push_back(SampleAt({U.lower() + i * (U.upper() - U.lower()) / lines,
                                    V.lower() + j * (V.upper() - V.lower()) / lines}));
      }
    }
    for (int i = 0; i <= lines; ++i) {
      for (int j = 0; j <= lines; ++j) {
        const Sample& here = samples[i * (lines + 1) + j];
        if (i < lines) JudgeBetween(here, samples[(i + 1) * (lines + 1) + j]);
        if (j < lines) JudgeBetween(here, samples[i * (lines + 1) + j + 1]);
      }
    }
    return judged_;
  }

 private:
  struct Sample {
    Eigen::Vector2d at;
    Eigen::Vector3d point;
    double distance;
    bool above, inside;
  };

  Sample SampleAt(const Eigen::Vector2d& at) const {
    const SplineBasis &S = b_.basis_u(), &T = b_.basis_v();
    const Eigen::Vector3d point = a_.At(at[0], at[1]);
    const SurfaceFoot foot = on_b_.Nearest(point);
    const auto normal = b_.NormalAt(foot.u, foot.v);
    const bool inside = normal && foot.u > S.lower() && foot.u < S.upper() && foot.v > T.lower() &&
                        foot.v < T.upper();
    return {at, point, foot.distance, inside && (point - foot.point).dot(*normal) > 0, inside};
  }

  void JudgeBetween(Sample x, Sample y) {
    constexpr int kHalvings = 40;
    for (int k = 0; k < kHalvings; ++k) {
      if (!x.inside || !y.inside || x.above == y.above) return;
      const Sample middle = SampleAt((x.at + y.at) / 2);
      (middle.above == x.above ? x : y) = middle;
    }
    // A jump of feet, not a crossing.
    if (!x.inside || x.distance > tolerance_ / 10) return;
    ++judged_;
    double least = 1e300;
    for (const CurveFootPoints<3>& one : feet_) {
      least = std::min(least, one.Nearest(x.point).distance);
    }
    EXPECT_LE(least, 2 * tolerance_) << "at " << x.point.transpose();
  }

  const NurbsSurface &a_, &b_;
  SurfaceFootPoints on_b_;
  double tolerance_;
  std::vector<CurveFootPoints<3>> feet_;
  int judged_ = 0;
};

int JudgeRandomPairs(int from, int to) {
  int judged = 0;
  for (int seed = from; seed < to; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const auto sheet = [&] {
      const int p = random.Integer(1, 4), q = random.Integer(1, 4);
      const NurbsSurface flat = random.Sheet(p, q, 1.2, {.most_spans = 5});
      const double scale = 1.0 / std::max(flat.size_u(), flat.size_v());
      const Eigen::Vector3d middle = flat.control_points().rowwise().mean();
      Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
      if (random.Coin()) turn = random.Orthogonal();
      return Placed(WithPoints(flat, (flat.control_points().colwise() - middle) * scale),
                    turn,
                    random.Vector(0.15));
    };
    const NurbsSurface a = sheet(), b = sheet();
    const SurfaceIntersection met = IntersectSurfaces(a, b);
    ExpectSound(a, b, met);
    judged += SideJudge(a, b, met).Judge(40);
    if (testing::Test::HasFailure()) return judged;
  }
  return judged;
}

TEST(IntersectSurfacesTest, NoBranchOfRandomPairsIsMissed) {
  EXPECT_GT(JudgeRandomPairs(0, 40), 40 * 5);
}

TEST(LongIntersectSurfacesTest, NoBranchOfFiveHundredRandomPairsIsMissed) {
  EXPECT_GT(JudgeRandomPairs(0, 500), 500 * 5);
}

TEST(IntersectSurfacesTest, SpheresMeetInACircleAcrossSeamsAndPoles) {
  const NurbsSurface a = MakeSphere({}, 1);
  RandomSplines random(7);
  for (int k = 0; k < 20; ++k) {
    SCOPED_TRACE(k);
    const Eigen::Vector3d apart = random.Real(0.3, 1.9) * random.Vector(1).normalized();
    const NurbsSurface b = Placed(MakeSphere({}, 1), random.Orthogonal(), apart);
    const SurfaceIntersection met = IntersectSurfaces(a, b);
    ASSERT_EQ(met.branches.size(), 1u);
    EXPECT_TRUE(met.branches[0].closed);
    ExpectSound(a, b, met);
    const double radius = std::sqrt(1 - apart.squaredNorm() / 4);
    EXPECT_NEAR(ArcLength(met.branches[0].curve), 2 * kPi * radius, 20 * met.tolerance);
    EXPECT_TRUE(met.touches.empty() && met.overlaps.empty());
  }
}

TEST(IntersectSurfacesTest, APlaneThroughTheAxisGoesThroughBothPoles) {
  const NurbsSurface sphere = MakeSphere({}, 1);
  for (const Eigen::Vector3d& normal :
       {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(1, 0.4, 0), Eigen::Vector3d(0, 1, 0)}) {
    const NurbsSurface plane = MakePlane(Frame({0, 0, 0}, normal), {-3, 3}, {-3, 3});
    const SurfaceIntersection met = IntersectSurfaces(sphere, plane);
    ASSERT_EQ(met.branches.size(), 1u);
    EXPECT_TRUE(met.branches[0].closed);
    EXPECT_NEAR(ArcLength(met.branches[0].curve), 2 * kPi, 20 * met.tolerance);
    ExpectSound(sphere, plane, met);
  }
}

TEST(IntersectSurfacesTest, EqualCylindersMeetInTwoEllipsesThatCrossTwice) {
  const NurbsSurface a = MakeCylinder({}, 1, {-2, 2});
  const NurbsSurface b = MakeCylinder(Frame({0, 0, 0}, {1, 0, 0}), 1, {-2, 2});
  const SurfaceIntersection met = IntersectSurfaces(a, b);
  ASSERT_EQ(met.branches.size(), 2u);
  for (const SurfaceBranch& branch : met.branches) {
    EXPECT_EQ(branch.kind, BranchKind::kTransversal);
    EXPECT_TRUE(branch.closed);
    // An ellipse of half axes √2 and 1.
    EXPECT_NEAR(ArcLength(branch.curve), 7.640395578055425, 20 * met.tolerance);
  }
  ASSERT_EQ(met.touches.size(), 2u);
  for (const SurfaceTouch& touch : met.touches) {
    EXPECT_TRUE(touch.on_branch);
    EXPECT_NEAR(std::abs(touch.point[1]), 1, met.tolerance);
  }
  ExpectSound(a, b, met);
}

TEST(IntersectSurfacesTest, TouchesArePointsAndCurves) {
  const NurbsSurface sphere = MakeSphere({}, 1);
  const NurbsSurface outside = Placed(sphere, Eigen::Matrix3d::Identity(), {2, 0, 0});
  const SurfaceIntersection point = IntersectSurfaces(sphere, outside);
  EXPECT_TRUE(point.branches.empty());
  ASSERT_EQ(point.touches.size(), 1u);
  EXPECT_LE((point.touches[0].point - Eigen::Vector3d(1, 0, 0)).norm(), point.tolerance);

  const NurbsSurface cylinder = MakeCylinder(Frame({0, 0, 0}, {1, 0, 0}), 1, {-2, 2});
  const NurbsSurface plane = MakePlane(Frame({0, 0, 1}, {0, 0, 1}), {-3, 3}, {-3, 3});
  const SurfaceIntersection line = IntersectSurfaces(cylinder, plane);
  ASSERT_EQ(line.branches.size(), 1u);
  EXPECT_EQ(line.branches[0].kind, BranchKind::kTangential);
  EXPECT_NEAR(ArcLength(line.branches[0].curve), 4, line.tolerance);
  EXPECT_TRUE(line.overlaps.empty());

  const NurbsSurface round = MakeCylinder({}, 1, {-2, 2});
  const SurfaceIntersection ring = IntersectSurfaces(sphere, round);
  ASSERT_EQ(ring.branches.size(), 1u);
  EXPECT_EQ(ring.branches[0].kind, BranchKind::kTangential);
  EXPECT_TRUE(ring.branches[0].closed);
  EXPECT_NEAR(ArcLength(ring.branches[0].curve), 2 * kPi, 20 * ring.tolerance);
  EXPECT_TRUE(ring.overlaps.empty());
}

TEST(IntersectSurfacesTest, CoincidentPartsAreOneRegionWithItsEdges) {
  const NurbsSurface a = MakePlane({}, {0, 1}, {0, 1});
  const NurbsSurface b = MakePlane({}, {0.5, 2}, {0.5, 2});
  const SurfaceIntersection met = IntersectSurfaces(a, b);
  ASSERT_EQ(met.overlaps.size(), 1u);
  EXPECT_NEAR(met.overlaps[0].first.u0, 0.5, 1.0 / 32);
  ASSERT_EQ(met.branches.size(), 4u);
  for (const SurfaceBranch& branch : met.branches) {
    EXPECT_EQ(branch.kind, BranchKind::kOverlap);
    EXPECT_NEAR(ArcLength(branch.curve), 0.5, 4 * met.tolerance);
  }
  ExpectSound(a, b, met);
}

TEST(IntersectSurfacesTest, ASharedEdgeIsOneBranch) {
  const NurbsSurface a = MakePlane({}, {0, 1}, {0, 1});
  const NurbsSurface b = MakePlane(Frame({0, 0, 0}, {0, 1, 0}), {0, 1}, {0, 1});
  const SurfaceIntersection met = IntersectSurfaces(a, b);
  ASSERT_EQ(met.branches.size(), 1u);
  EXPECT_NEAR(ArcLength(met.branches[0].curve), 1, met.tolerance);
}

TEST(IntersectSurfacesTest, PlaceAndScaleDoNotMatter) {
  RandomSplines random(11);
  const NurbsSurface a = random.Sheet(3, 3, 0.8, {.most_spans = 8});
  const NurbsSurface b = random.Sheet(3, 3, 0.8, {.most_spans = 8});
  const SurfaceIntersection here = IntersectSurfaces(a, b);
  ASSERT_FALSE(here.branches.empty());
  const auto total = [](const SurfaceIntersection& met) {
    double length = 0;
    for (const SurfaceBranch& branch : met.branches) length += ArcLength(branch.curve);
    return length;
  };
  for (const auto& [scale, shift] :
       {std::pair(1.0, 5e6), std::pair(1e-6, 0.0), std::pair(1e6, 0.0)}) {
    const Eigen::Matrix3d by = scale * Eigen::Matrix3d::Identity();
    const Eigen::Vector3d to(shift, -shift, shift);
    const SurfaceIntersection there = IntersectSurfaces(Placed(a, by, to), Placed(b, by, to));
    EXPECT_EQ(there.branches.size(), here.branches.size());
    EXPECT_NEAR(total(there) / scale, total(here), 1e3 * here.tolerance);
  }
}

TEST(IntersectSurfacesTest, BranchesEndAtTheTrimsOfBoth) {
  const NurbsSurface whole = MakePlane({}, {-2, 2}, {-2, 2});
  const NurbsSurface disk = whole.WithTrims({MakeArc(Eigen::Vector2d(0.5, 0.5), 0.25)});
  const NurbsSurface wall = MakePlane(Frame({0, 0, 0}, {0, 1, 0}), {-2, 2}, {-2, 2});
  const SurfaceIntersection met = IntersectSurfaces(disk, wall);
  ASSERT_EQ(met.branches.size(), 1u);
  EXPECT_NEAR(ArcLength(met.branches[0].curve), 2, 4 * met.tolerance);
  const NurbsSurface half = wall.WithTrims(
      {NurbsCurve<2>(SplineBasis(1, {0, 0, 1, 2, 3, 4, 4}),
                     (Eigen::Matrix2Xd(2, 5) << 0.5, 1, 1, 0.5, 0.5, 0, 0, 1, 1, 0).finished())});
  const SurfaceIntersection both = IntersectSurfaces(disk, half);
  ASSERT_EQ(both.branches.size(), 1u);
  EXPECT_NEAR(ArcLength(both.branches[0].curve), 1, 4 * both.tolerance);
  ExpectSound(disk, half, both);
}

// A pipe of the hole's own size: the branch is the loop.
TEST(IntersectSurfacesTest, ABranchAlongATrimIsWhole) {
  for (const double radius : {0.3, 2.0, 4.0}) {
    for (const bool hole : {true, false}) {
      SCOPED_TRACE(radius);
      const NurbsSurface whole = MakePlane({}, {-5, 5}, {-5, 5});
      const SplineBasis& u = whole.basis_u();
      const double unit = (u.upper() - u.lower()) / 10;
      const Eigen::Vector2d middle = Eigen::Vector2d::Constant(u.lower() / 2 + u.upper() / 2);
      std::vector<NurbsCurve<2>> loops{MakeArc(middle, radius * unit)};
      if (hole) {
        const double low = u.lower(), high = u.upper();
        loops.insert(
            loops.begin(),
            NurbsCurve<2>(
                SplineBasis(1, {0, 0, 1, 2, 3, 4, 4}),
                (Eigen::Matrix2Xd(2, 5) << low, high, high, low, low, low, low, high, high, low)
                    .finished()));
      }
      const NurbsSurface plate = whole.WithTrims(loops);
      const NurbsSurface pipe = MakeCylinder({}, radius, {-radius, radius});
      const SurfaceIntersection met = IntersectSurfaces(plate, pipe);
      ASSERT_EQ(met.branches.size(), 1u);
      EXPECT_TRUE(met.branches[0].closed);
      EXPECT_NEAR(ArcLength(met.branches[0].curve), 2 * kPi * radius, 20 * met.tolerance);
      ExpectSound(plate, pipe, met);
    }
  }
}

// Viviani's curve passes both poles, turned about the axis or not.
TEST(IntersectSurfacesTest, ABranchThroughPolesKeepsSmallTolerances) {
  for (const double turn : {0.0, 0.4}) {
    const NurbsSurface ball =
        Placed(MakeSphere({}, 2),
               Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ()).toRotationMatrix(),
               Eigen::Vector3d::Zero());
    const NurbsSurface pipe = MakeCylinder(Frame({1, 0, 0}, {0, 0, 1}), 1, {-3, 3});
    for (const double tolerance : {1e-5, 1e-7, 1e-8}) {
      SCOPED_TRACE(tolerance);
      const SurfaceIntersection met = IntersectSurfaces(pipe, ball, {.tolerance = tolerance});
      ASSERT_EQ(met.branches.size(), 1u);
      EXPECT_TRUE(met.branches[0].closed);
      // 8 √2 E(1/2), the complete elliptic integral.
      EXPECT_NEAR(ArcLength(met.branches[0].curve),
                  8 * std::sqrt(2.0) * 1.3506438810476755,
                  20 * tolerance);
      ExpectSound(pipe, ball, met);
    }
  }
}

// Circles about an axis, at a pole as anywhere else.
TEST(IntersectSurfacesTest, SmallCirclesAreFoundAboutPolesToo) {
  const NurbsSurface ball = MakeSphere({}, 1);
  for (const Eigen::Vector3d& direction : {Eigen::Vector3d(0, 0, 1),
                                           Eigen::Vector3d(0, 0, -1),
                                           Eigen::Vector3d(1, 0, 0),
                                           Eigen::Vector3d(2, 3, 6)}) {
    const Eigen::Vector3d axis = direction.normalized();
    for (const double depth : {1e-3, 1e-5, 1e-6}) {
      for (const double share : {0.1, 1e-3}) {
        SCOPED_TRACE(std::to_string(depth * 1e9) + "e-9, tolerances " + std::to_string(share));
        const NurbsSurface plane = MakePlane(Frame((1 - depth) * axis, axis), {-2, 2}, {-2, 2});
        const double tolerance = share * depth;
        const SurfaceIntersection met = IntersectSurfaces(ball, plane, {.tolerance = tolerance});
        ASSERT_EQ(met.branches.size(), 1u);
        EXPECT_TRUE(met.branches[0].closed);
        const double radius = std::sqrt(depth * (2 - depth));
        // A polygon's worth of what the tolerance is across at the circle's angle.
        EXPECT_NEAR(
            ArcLength(met.branches[0].curve), 2 * kPi * radius, 8 * kPi * tolerance / radius);
        EXPECT_TRUE(met.touches.empty() && met.overlaps.empty());
        ExpectSound(ball, plane, met);
      }
    }
  }
}

TEST(IntersectSurfacesTest, ATubeInItsSleeveTouchesAlongAClosedCircle) {
  for (const double scale : {1.0, 1e-6, 30.0}) {
    SCOPED_TRACE(scale);
    const NurbsSurface ring = MakeTorus({}, 2 * scale, 0.5 * scale);
    const NurbsSurface sleeve = MakeCylinder({}, 2.5 * scale, {-2 * scale, 2 * scale});
    const SurfaceIntersection met = IntersectSurfaces(ring, sleeve);
    ASSERT_EQ(met.branches.size(), 1u);
    EXPECT_EQ(met.branches[0].kind, BranchKind::kTangential);
    EXPECT_TRUE(met.branches[0].closed);
    EXPECT_NEAR(ArcLength(met.branches[0].curve), 5 * kPi * scale, 20 * met.tolerance);
    EXPECT_TRUE(met.touches.empty() && met.overlaps.empty());
    ExpectSound(ring, sleeve, met);
  }
}

// Creases, poles, wild weights, folds: an answer that is sound, or a refusal that says where.
TEST(IntersectSurfacesTest, NastySurfacesEndInTime) {
  int answered = 0;
  for (int kind = 0; kind < kNastyKinds; ++kind) {
    SCOPED_TRACE("kind " + std::to_string(kind));
    RandomSplines random(100 + kind);
    const NurbsSurface a = NastySurface(kind, random);
    const Eigen::Vector3d middle = a.control_points().rowwise().mean();
    const NurbsSurface b = MakePlane(Frame(middle, random.Vector(1)), {-9, 9}, {-9, 9});
    try {
      ExpectSound(a, b, IntersectSurfaces(a, b));
      ++answered;
    } catch (const std::invalid_argument& refusal) {
      EXPECT_NE(std::string(refusal.what()).find("near"), std::string::npos);
    }
  }
  EXPECT_GE(answered, kNastyKinds - 2);
}

TEST(IntersectSurfacesTest, ABadToleranceIsRefused) {
  const NurbsSurface plane = MakePlane({}, {0, 1}, {0, 1});
  EXPECT_THROW(IntersectSurfaces(plane, plane, {.tolerance = 0.0}), std::invalid_argument);
  EXPECT_THROW(IntersectSurfaces(plane, plane, {.tolerance = NAN}), std::invalid_argument);
  EXPECT_THROW(IntersectSurfaces(plane, plane, {.tolerance = 0.1}), std::invalid_argument);
}

}  // namespace batten::internal::intersect_surfaces_test
