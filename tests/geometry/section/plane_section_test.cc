// SPDX-License-Identifier: MIT
#include "batten/geometry/plane_section.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include "batten/geometry/arc_length.h"
#include "batten/geometry/make_curve.h"
#include "batten/geometry/make_surface.h"
#include "batten/geometry/transform.h"
#include "exact_shapes.h"
#include "random_splines.h"
#include "tolerances.h"
#include "angles.h"

namespace batten::internal::plane_section_test {

constexpr unsigned kSeeds = 60;
// The default tolerance of a section.
double ToleranceOf(const NurbsSurface& surface) { return 1e-9 * 2 * SizeOf(surface); }

// Both curves of every piece: on the surface, in the plane, in the domain; above on the left.
void ExpectSound(const NurbsSurface& surface, const Plane& plane, const PlaneSection& section) {
  const double tolerance = ToleranceOf(surface) + 1e-15 * ExtentOf(surface);
  const SplineBasis &U = surface.basis_u(), &V = surface.basis_v();
  for (const SectionCurve& curve : section.curves) {
    const SplineBasis& basis = curve.points.basis();
    ASSERT_EQ(basis, curve.parameters.basis());
    constexpr int kPlaces = 200;
    for (int k = 0; k <= kPlaces; ++k) {
      const double t = basis.lower() + k * (basis.upper() - basis.lower()) / kPlaces;
      const Eigen::Vector2d at = curve.parameters.At(t);
      const Eigen::Vector3d point = curve.points.At(t);
      EXPECT_LE((surface.At(at[0], at[1]) - point).norm(), 1.5 * tolerance)
          << t << " in " << basis.knots()[basis.Span(t)] << " " << basis.knots()[basis.Span(t) + 1]
          << " at " << at.transpose();
      EXPECT_LE(std::abs(HeightAbove(plane, point)), tolerance);
      EXPECT_GE(at[0], U.lower() - 1e-6 * (U.upper() - U.lower()));
      EXPECT_LE(at[0], U.upper() + 1e-6 * (U.upper() - U.lower()));
      EXPECT_GE(at[1], V.lower() - 1e-6 * (V.upper() - V.lower()));
      EXPECT_LE(at[1], V.upper() + 1e-6 * (V.upper() - V.lower()));
      if (testing::Test::HasFailure()) return;
    }
    if (curve.closed) {
      EXPECT_EQ(curve.points.At(basis.lower()), curve.points.At(basis.upper()));
    }
  }
}

// Between two samples of the surface on different sides there is a curve: for all neighbours in a
// dense grid a polyline of the curves crosses the segment between them. Tested by counting, along
// every grid line, the crossings of the curves against the changes of sign.
void ExpectComplete(const NurbsSurface& surface,
                    const Plane& plane,
                    const PlaneSection& section,
                    int lines) {
  const SplineBasis &U = surface.basis_u(), &V = surface.basis_v();
  std::vector<std::vector<Eigen::Vector2d>> polylines;
  for (const SectionCurve& curve : section.curves) {
    const SplineBasis& basis = curve.parameters.basis();
    std::vector<Eigen::Vector2d> line;
    for (const int span : basis.Spans()) {
      const double a = basis.knots()[span], b = basis.knots()[span + 1];
      for (int k = 0; k < 16; ++k) line.push_back(curve.parameters.At(a + k * (b - a) / 16));
    }
    line.push_back(curve.parameters.At(basis.upper()));
    polylines.push_back(std::move(line));
  }
  constexpr int kSamples = 1500;
  const double golden = 0.6180339887498949;
  for (int k = 0; k < lines; ++k) {
    const double share = std::fmod(0.11 + k * golden, 1.0);
    for (const bool along_u : {true, false}) {
      const SplineBasis &A = along_u ? U : V, &B = along_u ? V : U;
      const double fixed = B.lower() + share * (B.upper() - B.lower());
      int changes = 0;
      bool close = false, last = false;
      for (int i = 0; i <= kSamples; ++i) {
        const double x = A.lower() + i * (A.upper() - A.lower()) / kSamples;
        const double height =
            HeightAbove(plane, along_u ? surface.At(x, fixed) : surface.At(fixed, x));
        const bool above = height >= 0;
        if (i > 0 && above != last) ++changes;
        last = above;
        // A line that nearly touches may be counted either way.
        close = close || std::abs(height) < 1e-7 * SizeOf(surface);
      }
      int crossings = 0;
      for (const auto& line : polylines) {
        for (std::size_t i = 1; i < line.size(); ++i) {
          const int c = along_u ? 1 : 0;
          if ((line[i - 1][c] < fixed) != (line[i][c] < fixed)) ++crossings;
        }
      }
      // Samples see no two changes between neighbours: never more curves missing than that.
      EXPECT_GE(crossings, changes - (close ? 1 : 0)) << (along_u ? "v = " : "u = ") << fixed;
      EXPECT_EQ((crossings - changes) % 2 == 0 || close, true);
    }
  }
}

double LengthOf(const std::vector<NurbsCurve<3>>& curves) {
  double length = 0;
  for (const auto& curve : curves) length += ArcLength(curve);
  return length;
}

std::vector<NurbsCurve<3>> InSpace(const NurbsSurface& surface, const PlaneSection& section) {
  std::vector<NurbsCurve<3>> curves;
  for (const SectionCurve& curve : section.curves) curves.push_back(curve.points);
  for (const SectionCurve& curve : section.edges) curves.push_back(curve.points);
  return JoinedInSpace(curves, 1e-6 * SizeOf(surface));
}

bool ClosedInSpace(const NurbsCurve<3>& c, double size) {
  return (c.At(c.basis().lower()) - c.At(c.basis().upper())).norm() <= 1e-6 * size;
}

TEST(PlaneSectionTest, APlaneCutsASphereInACircle) {
  RandomSplines random(1);
  const NurbsSurface sphere = MakeSphere({}, 1);
  for (int k = 0; k < 60; ++k) {
    SCOPED_TRACE("case " + std::to_string(k));
    Eigen::Vector3d normal = random.Vector(1).normalized();
    double d = random.Real(-0.99, 0.99);
    if (k < 6) normal = Eigen::Vector3d::Unit(k % 3);
    if (k < 3) d = 0;
    if (k >= 6 && k < 12) normal[k % 3] = 0;
    if (k >= 9 && k < 12) d = 0;
    normal.normalize();
    const Plane plane{3 * normal, 3 * d};
    const PlaneSection section = Section(sphere, plane);
    ExpectSound(sphere, plane, section);
    const auto curves = InSpace(sphere, section);
    ASSERT_EQ(curves.size(), 1u);
    EXPECT_TRUE(ClosedInSpace(curves[0], 1));
    const double radius = std::sqrt(1 - d * d);
    EXPECT_NEAR(LengthOf(curves), 2 * kPi * radius, 1e-8);
    for (int i = 0; i <= 40; ++i) {
      const SplineBasis& basis = curves[0].basis();
      const double t = basis.lower() + i * (basis.upper() - basis.lower()) / 40;
      EXPECT_NEAR((curves[0].At(t) - d * normal).norm(), radius, 2 * ToleranceOf(sphere));
    }
    if (testing::Test::HasFailure()) return;
  }
}

TEST(PlaneSectionTest, ObliquePlanesCutATorusInOneOrTwoLoops) {
  const double major = 2, minor = 0.7;
  const NurbsSurface torus = MakeTorus({}, major, minor);
  const double villarceau = std::asin(minor / major);
  for (int k = 0; k < 40; ++k) {
    const double tilt = (k + 0.5) / 40 * kPi / 2, turn = 0.3 + k;
    SCOPED_TRACE("tilt " + std::to_string(tilt));
    const Plane plane{
        {std::sin(tilt) * std::cos(turn), std::sin(tilt) * std::sin(turn), std::cos(tilt)}, 0};
    const PlaneSection section = Section(torus, plane);
    ExpectSound(torus, plane, section);
    const auto curves = InSpace(torus, section);
    // Through the centre: two loops always, one inside the other below Villarceau's angle and side
    // by side above it.
    EXPECT_EQ(curves.size(), 2u);
    for (const auto& curve : curves) EXPECT_TRUE(ClosedInSpace(curve, 1));
  }
  // Villarceau: two circles of radius `major`.
  const Plane plane{{std::sin(villarceau), 0, std::cos(villarceau)}, 0};
  const PlaneSection section = Section(torus, plane);
  ExpectSound(torus, plane, section);
  EXPECT_NEAR(LengthOf(InSpace(torus, section)), 2 * 2 * kPi * major, 1e-3);
}

TEST(PlaneSectionTest, PlanesAcrossTheAxisCutATorusInTwoOrOneOrNoLoop) {
  const NurbsSurface torus = MakeTorus({}, 2, 0.7);
  const auto loops = [&](const Plane& plane) {
    const PlaneSection section = Section(torus, plane);
    ExpectSound(torus, plane, section);
    return InSpace(torus, section).size();
  };
  EXPECT_EQ(loops({{0, 0, 1}, 0.0}), 2u);
  EXPECT_EQ(loops({{0, 0, 1}, 0.3}), 2u);
  EXPECT_EQ(loops({{0, 0, 1}, 0.71}), 0u);
  EXPECT_EQ(loops({{0, 0, 1}, 0.7}), 0u);   // touches along a circle
  EXPECT_EQ(loops({{0, 0, 1}, -0.7}), 0u);  // from the other side
  EXPECT_EQ(loops({{1, 0, 0}, 0.0}), 2u);
  EXPECT_EQ(loops({{1, 0, 0}, 1.0}), 2u);
  EXPECT_EQ(loops({{1, 0, 0}, 2.0}), 1u);
  EXPECT_EQ(loops({{1, 0, 0}, 2.7}), 0u);
  EXPECT_EQ(loops({{1, 0, 0}, 2.8}), 0u);
  EXPECT_EQ(loops({{-1, 0, 0}, 2.0}), 1u);
  EXPECT_EQ(loops({{-1, 0, 0}, 2.7}), 0u);
}

TEST(PlaneSectionTest, NoChangeOfSideIsMissedOnWavySheets) {
  for (unsigned seed = 0; seed < kSeeds; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const NurbsSurface surface =
        random.Sheet(random.Integer(1, 5), random.Integer(1, 5), 1.5, {.most_spans = 8});
    Eigen::Vector3d normal = random.Vector(0.3);
    normal[2] += 1;
    const Plane plane{normal,
                      normal.dot(surface.At(random.Parameter(surface.basis_u()),
                                            random.Parameter(surface.basis_v())))};
    const PlaneSection section = Section(surface, plane);
    ExpectSound(surface, plane, section);
    ExpectComplete(surface, plane, section, 25);
    if (testing::Test::HasFailure()) return;
  }
}

TEST(PlaneSectionTest, NoChangeOfSideIsMissedOnRandomSurfaces) {
  for (unsigned seed = 0; seed < kSeeds; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(1000 + seed);
    const NurbsSurface surface = random.Surface(random.Integer(1, 5),
                                                random.Integer(1, 5),
                                                false,
                                                {.clamped = random.Coin(), .most_spans = 4});
    const Plane plane{random.Vector(1), random.Real(-0.3, 0.3)};
    const PlaneSection section = Section(surface, plane);
    ExpectSound(surface, plane, section);
    ExpectComplete(surface, plane, section, 15);
    if (testing::Test::HasFailure()) return;
  }
}

TEST(PlaneSectionTest, SmallLoopsAreFound) {
  // A bump of height 1 on a plane, cut just below its top: f = top − (x² + y²)/2 there.
  const NurbsSurface sphere = MakeSphere({{0.3, 0.2, 0}, {1, 2, 3}}, 1);
  for (const double below : {1e-2, 1e-4, 1e-6, 1e-8}) {
    SCOPED_TRACE("below " + std::to_string(below));
    const Eigen::Vector3d normal = Eigen::Vector3d(-1, 0.3, 0.7).normalized();
    const Plane plane{normal, normal.dot(Eigen::Vector3d(0.3, 0.2, 0)) + 1 - below};
    const PlaneSection section = Section(sphere, plane);
    const auto curves = InSpace(sphere, section);
    ASSERT_EQ(curves.size(), 1u);
    EXPECT_NEAR(LengthOf(curves),
                2 * kPi * std::sqrt(2 * below - below * below),
                4 * kPi * ToleranceOf(sphere) / std::sqrt(2 * below) + 1e-8);
  }
}

TEST(PlaneSectionTest, EdgesAndPatchesInThePlane) {
  const NurbsSurface cylinder = MakeCylinder({}, 1, {0, 2});
  const PlaneSection bottom = Section(cylinder, {{0, 0, 1}, 0});
  EXPECT_TRUE(bottom.curves.empty());
  ASSERT_EQ(bottom.edges.size(), 1u);
  EXPECT_NEAR(ArcLength(bottom.edges[0].points), 2 * kPi, 1e-9);
  const PlaneSection below = Section(cylinder, {{0, 0, -1}, 0});
  EXPECT_TRUE(below.curves.empty());
  EXPECT_EQ(below.edges.size(), 1u);
  const NurbsSurface plane = MakePlane({}, {0, 1}, {0, 1});
  const PlaneSection all = Section(plane, {{0, 0, 1}, 0});
  EXPECT_TRUE(all.contains_patch);
  EXPECT_TRUE(all.curves.empty());
  const PlaneSection line = Section(plane, {{1, 1, 0}, 0.7});
  ASSERT_EQ(line.curves.size(), 1u);
  EXPECT_NEAR(ArcLength(line.curves[0].points), 0.7 * std::sqrt(2), 1e-9);
  EXPECT_EQ(line.curves[0].points.control_points().cols(), 4);  // a straight line is one cubic
}

TEST(PlaneSectionTest, UnitsAndFarOriginsChangeNothing) {
  RandomSplines random(5);
  const NurbsSurface surface = random.Sheet(3, 3, 1.0, {.most_spans = 8});
  const Plane plane{{0.1, -0.2, 1}, 0.1};
  const PlaneSection here = Section(surface, plane);
  ASSERT_FALSE(here.curves.empty());
  for (const double unit : {1e-6, 1e6}) {
    const NurbsSurface other = Transformed(surface, Scaling(unit));
    const PlaneSection there = Section(other, {plane.normal, unit * plane.offset});
    ExpectSound(other, {plane.normal, unit * plane.offset}, there);
    EXPECT_EQ(there.curves.size(), here.curves.size());
  }
  const Eigen::Vector3d far(5e6, -5e6, 5e6);
  const Plane moved{plane.normal, plane.offset + plane.normal.dot(far)};
  const NurbsSurface other = surface.Translated(far);
  const PlaneSection there = Section(other, moved, {.tolerance = 1e-7});
  EXPECT_EQ(there.curves.size(), here.curves.size());
  for (const SectionCurve& curve : there.curves) {
    for (const double t : curve.points.basis().knots()) {
      const Eigen::Vector2d at = curve.parameters.At(t);
      EXPECT_LE((other.At(at[0], at[1]) - curve.points.At(t)).norm(), 2e-7);
    }
  }
}

TEST(PlaneSectionTest, RefusesWhatIsNoPlane) {
  const NurbsSurface sphere = MakeSphere({}, 1);
  EXPECT_THROW(Section(sphere, {{0, 0, 0}, 0}), std::invalid_argument);
  EXPECT_THROW(Section(sphere, {{0, 0, std::nan("")}, 0}), std::invalid_argument);
  EXPECT_THROW(Section(sphere, {{0, 0, 1}, std::nan("")}), std::invalid_argument);
  EXPECT_THROW(Section(sphere, {{0, 0, 1}, 0}, {.tolerance = 0}), std::invalid_argument);
}

TEST(CrossingsTest, FindsEveryCrossingOfACurve) {
  for (unsigned seed = 0; seed < 100; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const NurbsCurve<3> curve = random.Curve<3>(random.Integer(1, 7), random.Coin());
    const Plane plane{random.Vector(1), random.Real(-0.2, 0.2)};
    const auto crossings = Crossings(curve, plane, 1e-10);
    const auto& basis = curve.basis();
    int changes = 0;
    constexpr int kSamples = 20000;
    for (int k = 1; k <= kSamples; ++k) {
      const auto height = [&](int i) {
        return HeightAbove(
            plane, curve.At(basis.lower() + i * (basis.upper() - basis.lower()) / kSamples));
      };
      if ((height(k) > 0) != (height(k - 1) > 0)) ++changes;
    }
    int crosses = 0;
    for (const PlaneCrossing& one : crossings) {
      EXPECT_NEAR(HeightAbove(plane, curve.At(one.u)), 0, 1e-9);
      if (!one.touches) ++crosses;
    }
    EXPECT_EQ(crosses, changes);
  }
}

TEST(CrossingsTest, TellsTouchingFromCrossing) {
  const NurbsCurve<3> circle = MakeArc(Frame(), 1);
  EXPECT_EQ(Crossings(circle, {{1, 0, 0}, 0.5}, 1e-9).size(), 2u);
  EXPECT_EQ(Crossings(circle, {{1, 0, 0}, 1.5}, 1e-9).size(), 0u);
  const auto touch = Crossings(circle, {{0, 1, 0}, 1}, 1e-9);
  ASSERT_EQ(touch.size(), 1u);
  EXPECT_TRUE(touch[0].touches);
  EXPECT_NEAR(circle.At(touch[0].u)[1], 1, 1e-9);
  const auto within = Crossings(circle, {{0, 0, 1}, 0}, 1e-9);
  ASSERT_EQ(within.size(), 2u);
  EXPECT_EQ(within[0].u, circle.basis().lower());
  EXPECT_EQ(within[1].u, circle.basis().upper());
}

}  // namespace batten::internal::plane_section_test
