// SPDX-License-Identifier: MIT
#include "batten/geometry/cut_surface.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include "batten/geometry/arc_length.h"
#include "batten/geometry/extend.h"
#include "batten/geometry/make_curve.h"
#include "batten/geometry/make_surface.h"
#include "batten/geometry/project_curve.h"
#include "batten/geometry/surface_area.h"
#include "batten/geometry/trim_loops.h"
#include "batten/geometry/trim_region.h"
#include "exact_shapes.h"
#include "random_splines.h"
#include "tolerances.h"
#include "angles.h"

namespace batten::internal::cut_surface_test {

// To the trimmed area's own 1e-10 of what it adds and subtracts, and the tolerance of the curves.
constexpr double kOfTheArea = 1e-7;

double AreaOf(const std::vector<NurbsSurface>& parts) {
  double area = 0;
  for (const NurbsSurface& part : parts) area += Area(part);
  return area;
}

// Areas add up; every place is in the part whose side it is on.
void ExpectParts(const NurbsSurface& surface, const Plane& plane, const SurfaceCut& cut) {
  const double area = Area(surface);
  EXPECT_NEAR(AreaOf(cut.left) + AreaOf(cut.right), area, kOfTheArea * area);
  const TrimRegion whole(surface);
  const SplineBasis &U = surface.basis_u(), &V = surface.basis_v();
  std::vector<TrimRegion> left, right;
  for (const NurbsSurface& part : cut.left) left.emplace_back(part);
  for (const NurbsSurface& part : cut.right) right.emplace_back(part);
  const auto count = [](const std::vector<NurbsSurface>& parts,
                        const std::vector<TrimRegion>& regions,
                        double u,
                        double v) {
    int n = 0;
    for (std::size_t k = 0; k < parts.size(); ++k) {
      const SplineBasis &A = parts[k].basis_u(), &B = parts[k].basis_v();
      if (u < A.lower() || u > A.upper() || v < B.lower() || v > B.upper()) continue;
      n += regions[k].Contains(u, v);
    }
    return n;
  };
  constexpr int kGrid = 41;
  for (int i = 0; i < kGrid; ++i) {
    for (int j = 0; j < kGrid; ++j) {
      const double u = U.lower() + (i + 0.377) / kGrid * (U.upper() - U.lower());
      const double v = V.lower() + (j + 0.611) / kGrid * (V.upper() - V.lower());
      const double height = HeightAbove(plane, surface.At(u, v));
      if (std::abs(height) < 1e-6 * SizeOf(surface)) continue;
      const bool counts = whole.Contains(u, v), above = height > 0;
      EXPECT_EQ(count(cut.left, left, u, v), counts && above ? 1 : 0) << u << ", " << v;
      EXPECT_EQ(count(cut.right, right, u, v), counts && !above ? 1 : 0) << u << ", " << v;
      if (testing::Test::HasFailure()) return;
    }
  }
}

TEST(CutByPlaneTest, PartsOfWavySheetsAddUp) {
  for (unsigned seed = 0; seed < 15; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const NurbsSurface surface = random.Sheet(random.Integer(2, 4),
                                              random.Integer(2, 4),
                                              1.0,
                                              {.most_spans = 5, .highest_multiplicity = 1});
    Eigen::Vector3d normal = random.Vector(0.3);
    normal[2] += 1;
    const Plane plane{
        normal,
        normal.dot(surface.At(random.Real(surface.basis_u().lower(), surface.basis_u().upper()),
                              random.Real(surface.basis_v().lower(), surface.basis_v().upper())))};
    ExpectParts(surface, plane, CutByPlane(surface, plane));
    if (testing::Test::HasFailure()) return;
  }
}

TEST(CutByPlaneTest, ACapOfASphereHasItsArea) {
  RandomSplines random(2);
  const NurbsSurface sphere = MakeSphere({}, 1);
  for (int k = 0; k < 8; ++k) {
    SCOPED_TRACE("case " + std::to_string(k));
    const Eigen::Vector3d normal =
        k == 0 ? Eigen::Vector3d::UnitZ() : random.Vector(1).normalized();
    const double d = random.Real(-0.95, 0.95);
    const Plane plane{normal, d};
    const SurfaceCut cut = CutByPlane(sphere, plane);
    ExpectParts(sphere, plane, cut);
    EXPECT_NEAR(AreaOf(cut.left), 2 * kPi * (1 - d), 1e-6);
    if (testing::Test::HasFailure()) return;
  }
}

TEST(CutByPlaneTest, TrimmedPartsAreCutAgain) {
  const NurbsSurface plate = MakePlane({}, {0, 4}, {0, 3});
  const NurbsCurve<2> disc = MakeArc(Eigen::Vector2d(0.5, 0.5), 0.2);
  const SurfaceCut holed = CutAlong(plate, disc);
  ASSERT_EQ(holed.right.size(), 1u);
  ASSERT_EQ(holed.left.size(), 1u);
  EXPECT_EQ(holed.right[0].trims().size(), 2u);
  EXPECT_NEAR(Area(holed.left[0]), 12 * 0.04 * kPi, 1e-8);
  // Through the hole, beside it, and along the middle of it.
  for (const double x : {0.3, 1.3, 2.0, 2.5, 3.3}) {
    SCOPED_TRACE("x = " + std::to_string(x));
    const Plane plane{{1, 0.2, 0}, x};
    const SurfaceCut cut = CutByPlane(holed.right[0], plane);
    EXPECT_EQ(cut.left.size(), 1u);
    EXPECT_EQ(cut.right.size(), 1u);
    ExpectParts(holed.right[0], plane, cut);
  }
  // A ring cut in two, across.
  const SurfaceCut ring = CutAlong(holed.right[0], MakeArc(Eigen::Vector2d(0.5, 0.5), 0.4));
  ASSERT_EQ(ring.left.size(), 1u);
  EXPECT_EQ(ring.left[0].trims().size(), 2u);
  const SurfaceCut halves = CutByPlane(ring.left[0], {{1, 0, 0}, 2});
  ASSERT_EQ(halves.left.size(), 1u);
  ASSERT_EQ(halves.right.size(), 1u);
  EXPECT_EQ(halves.left[0].trims().size(), 1u);
  EXPECT_NEAR(Area(halves.left[0]), Area(ring.left[0]) / 2, 1e-8);
}

TEST(CutByPlaneTest, SeveralPartsOnOneSide) {
  // A sheet with a wave: z = sin, cut at half its height.
  Eigen::Matrix3Xd points(3, 9 * 2);
  for (int i = 0; i < 9; ++i) {
    for (int j = 0; j < 2; ++j) points.col(2 * i + j) << i, 3 * j, (i % 4 < 2 ? 1 : -1);
  }
  const NurbsSurface wave(
      SplineBasis::Uniform(2, 9, 0, 1), SplineBasis::Uniform(1, 2, 0, 1), points);
  const Plane plane{{0.05, 0.1, 1}, 0.4};
  const SurfaceCut cut = CutByPlane(wave, plane);
  EXPECT_GT(cut.left.size() + cut.right.size(), 3u);
  ExpectParts(wave, plane, cut);
}

TEST(CutByPlaneTest, AnIsoLineSplitsExactly) {
  const NurbsSurface cylinder = MakeCylinder({}, 1, {0, 4});
  const SurfaceCut cut = CutByPlane(cylinder, {{0, 0, 1}, 1});
  ASSERT_EQ(cut.left.size(), 1u);
  ASSERT_EQ(cut.right.size(), 1u);
  EXPECT_FALSE(cut.left[0].trimmed());
  EXPECT_FALSE(cut.right[0].trimmed());
  EXPECT_NEAR(Area(cut.left[0]), 6 * kPi, 1e-9);
  const SurfaceCut halves = CutByPlane(cylinder, {{0, 1, 0}, 0});
  EXPECT_EQ(halves.left.size() + halves.right.size(), 2u);
  EXPECT_NEAR(AreaOf(halves.left), 4 * kPi, 1e-9);
}

TEST(CutByPlaneTest, BothSidesShareTheCurve) {
  RandomSplines random(4);
  const NurbsSurface surface = random.Sheet(3, 3, 0.3, {.most_spans = 5});
  const double x = (surface.size_u() - 1) / 2.0;
  const SurfaceCut cut = CutByPlane(surface, {{1, 0.1, 0}, x});
  ASSERT_EQ(cut.left.size(), 1u);
  ASSERT_EQ(cut.right.size(), 1u);
  // Most control points of either loop are the other's.
  int shared = 0;
  const auto& a = cut.left[0].trims()[0].control_points();
  const auto& b = cut.right[0].trims()[0].control_points();
  for (const auto& p : a.colwise()) {
    for (const auto& q : b.colwise()) shared += p == q;
  }
  EXPECT_GT(shared, a.cols() / 2);
}

TEST(SectionInsideTest, EndsAtTheLoops) {
  const NurbsSurface plate = MakePlane({}, {0, 4}, {0, 3});
  const SurfaceCut holed = CutAlong(plate, MakeArc(Eigen::Vector2d(0.5, 0.5), 0.2));
  // Through the middle of the hole, an ellipse with the half axes 0.8 and 0.6.
  const auto length = [](const NurbsSurface& surface, const Plane& plane) {
    double sum = 0;
    for (const SectionCurve& curve : SectionInside(surface, Section(surface, plane)).curves) {
      sum += ArcLength(curve.points);
    }
    return sum;
  };
  const Plane middle{{1, 0, 0}, 2}, beside{{1, 0, 0}, 3};
  EXPECT_NEAR(length(holed.right.at(0), middle), 3 - 1.2, 1e-8);
  EXPECT_NEAR(length(holed.left.at(0), middle), 1.2, 1e-8);
  EXPECT_NEAR(length(holed.right.at(0), beside), 3, 1e-8);
  EXPECT_EQ(length(holed.left.at(0), beside), 0);
}

TEST(CutByPlaneTest, AnExtendedSurfaceCutAtItsOldEdgeIsTheOldOne) {
  const NurbsSurface plate = MakePlane({{5e6, -5e6, 10}, {1, 2, 3}}, {0, 2}, {0, 1});
  const NurbsSurface longer = Extended(plate, {Direction::kU, true}, 0.5);
  const Eigen::Vector3d along = plate.At(1, 0) - plate.At(0, 0);
  const SurfaceCut cut = CutByPlane(longer, {along, along.dot(plate.At(1, 0))});
  ASSERT_EQ(cut.left.size(), 1u);
  ASSERT_EQ(cut.right.size(), 1u);
  EXPECT_NEAR(Area(cut.right[0]), 2, 1e-7);  // coordinates of 5e6 are right to 1e-9
  EXPECT_NEAR(Area(cut.left[0]), 0.5, 1e-7);
}

TEST(CutByPlaneTest, WhatIsNotCutComesWhole) {
  const NurbsSurface sphere = MakeSphere({}, 1);
  for (const double d : {2.0, 1.0, -1.0, -2.0}) {
    const SurfaceCut cut = CutByPlane(sphere, {{0, 0, 1}, d});
    EXPECT_EQ(cut.left.size(), d < 0 ? 1u : 0u) << d;
    EXPECT_EQ(cut.right.size(), d < 0 ? 0u : 1u) << d;
  }
}

TEST(CutAlongTest, AThroughGoingCurve) {
  const NurbsSurface plate = MakePlane({}, {0, 1}, {0, 1});
  const double ends[] = {0, 1};
  const NurbsCurve<2> line(SplineBasis::Clamped(1, ends), Eigen::Matrix2d{{-0.5, 1.5}, {0.2, 0.4}});
  const SurfaceCut cut = CutAlong(plate, line);
  ASSERT_EQ(cut.left.size(), 1u);
  ASSERT_EQ(cut.right.size(), 1u);
  EXPECT_NEAR(Area(cut.right[0]), 0.3, 1e-9);
  EXPECT_NEAR(Area(cut.left[0]), 0.7, 1e-9);
  const NurbsCurve<2> inside(SplineBasis::Clamped(1, ends),
                             Eigen::Matrix2d{{-0.5, 0.5}, {0.2, 0.4}});
  EXPECT_THROW(CutAlong(plate, inside), std::invalid_argument);
  const NurbsCurve<2> away(SplineBasis::Clamped(1, ends), Eigen::Matrix2d{{-0.5, 1.5}, {2.2, 2.4}});
  EXPECT_THROW(CutAlong(plate, away), std::invalid_argument);
  const NurbsCurve<2> edge(SplineBasis::Clamped(1, ends), Eigen::Matrix2d{{0, 1}, {0, 0}});
  EXPECT_THROW(CutAlong(plate, edge), std::invalid_argument);
  const NurbsCurve<2> clockwise = MakeArc(Eigen::Vector2d(0.5, 0.5), 0.3);
  EXPECT_NEAR(AreaOf(CutAlong(plate, clockwise).left), 0.09 * kPi, 1e-8);
}

TEST(CutAlongTest, ACurveInSpaceIsProjected) {
  const NurbsSurface sphere = MakeSphere({}, 1, {0.3, 4}, {-1.2, 1.2});
  // A circle above the sphere: its feet are a circle on it.
  const Eigen::Vector3d axis = Eigen::Vector3d(-0.6, 0.7, 0.2).normalized();
  const NurbsCurve<3> circle = MakeArc(Frame(1.1 * axis, axis), 0.33);
  const SurfaceCut cut = CutAlong(sphere, circle, 1e-8);
  ASSERT_EQ(cut.left.size(), 1u);
  const double half = std::atan(0.33 / 1.1);
  EXPECT_NEAR(Area(cut.left[0]), 2 * kPi * (1 - std::cos(half)), 1e-6);
  // A line over the whole sheet and beyond it on both sides.
  RandomSplines random(9);
  const NurbsSurface sheet = random.Sheet(3, 3, 0.1, {.most_spans = 5, .highest_multiplicity = 1});
  const double ends[] = {0, 1};
  const double y = (sheet.size_v() - 1) / 2.0;
  const NurbsCurve<3> line(
      SplineBasis::Clamped(1, ends),
      Eigen::Matrix<double, 3, 2>{{-3.0, sheet.size_u() + 2.0}, {y, y + 0.3}, {0, 0}});
  const SurfaceCut halves = CutAlong(sheet, line, 1e-7);
  EXPECT_EQ(halves.left.size(), 1u);
  EXPECT_EQ(halves.right.size(), 1u);
  EXPECT_NEAR(AreaOf(halves.left) + AreaOf(halves.right), Area(sheet), 1e-6);
}

}  // namespace batten::internal::cut_surface_test
