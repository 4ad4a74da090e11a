// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>
#include <Eigen/Dense>

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

#include "batten/geometry/make_surface.h"
#include "batten/geometry/offset_surface.h"
#include "nasty_surfaces.h"
#include "random_splines.h"
#include "tolerances.h"

namespace batten::internal::offset_surface_test {

double FarthestFromExact(const NurbsSurface& surface, const NurbsSurface& offset, double d, int n) {
  const SplineBasis &U = surface.basis_u(), &V = surface.basis_v();
  double most = 0;
  for (int i = 0; i <= n; ++i) {
    for (int j = 0; j <= n; ++j) {
      const double u = U.lower() + i * (U.upper() - U.lower()) / n;
      const double v = V.lower() + j * (V.upper() - V.lower()) / n;
      const auto normal = surface.NormalAt(u, v);
      if (!normal) continue;
      most = std::max(most, (offset.At(u, v) - surface.At(u, v) - d * *normal).norm());
    }
  }
  return most;
}

TEST(OffsetSurfaceTest, KeepsTheToleranceBetweenSamples) {
  for (unsigned seed = 0; seed < 6; ++seed) {
    RandomSplines random(seed);
    const NurbsSurface sheet =
        random.Sheet(random.Integer(3, 4), 3, 0.25, {.most_spans = 5, .highest_multiplicity = 1});
    for (const double tolerance : {1e-3, 1e-5}) {
      const SurfaceOffset offset = OffsetSurface(sheet, 0.1, {.tolerance = tolerance});
      EXPECT_TRUE(offset.tolerance_reached);
      EXPECT_LE(FarthestFromExact(sheet, offset.surface, 0.1, 211), tolerance);
    }
  }
}

TEST(OffsetSurfaceTest, AnalyticShapesStayWhatTheyAre) {
  for (const NurbsSurface& shape : {MakePlane({}, {0, 2}, {0, 1}),
                                    MakeSphere({}, 2),
                                    MakeCylinder({}, 1.5, {0, 3}),
                                    MakeCone({}, 1, 0.2, {0, 2}),
                                    MakeTorus({}, 2, 0.5)}) {
    for (const double d : {0.1, -0.1}) {
      const SurfaceOffset offset = OffsetSurface(shape, d);
      EXPECT_TRUE(offset.exact);
      EXPECT_EQ(offset.surface.weights(), shape.weights());
      EXPECT_LE(FarthestFromExact(shape, offset.surface, d, 60), 10 * kRounding);
    }
  }
}

// Each arc of a spindle by itself; a tube through the axis has opposite normals on its two sides.
TEST(OffsetSurfaceTest, TheArcsOfASpindleMoveAlongTheirOwnNormals) {
  constexpr double kPi = std::numbers::pi, kTolerance = 1e-5;
  for (const double major : {0.2, 0.8}) {
    const double axis = std::acos(major);
    for (const double d : {0.05, -0.05}) {
      for (const AngleRange& tube : {AngleRange{kPi - 0.6 * axis, 1.2 * axis},
                                     AngleRange{-0.8 * (kPi - axis), 1.6 * (kPi - axis)}}) {
        const NurbsSurface shape = MakeTorus({}, major, 1, {}, tube);
        const SurfaceOffset offset = OffsetSurface(shape, d, {.tolerance = kTolerance});
        EXPECT_LE(FarthestFromExact(shape, offset.surface, d, 60), kTolerance);
      }
    }
    EXPECT_THROW(OffsetSurface(MakeTorus({}, major, 1), -0.05), std::invalid_argument);
    EXPECT_THROW(OffsetSurface(MakeTorus({}, major, 1, {}, {kPi / 2, kPi}), -0.05),
                 std::invalid_argument);
  }
}

// A patch so thin and so far from zero that its normals are rounding: more rows gain nothing.
TEST(OffsetSurfaceTest, EndsWhereRoundingHidesTheTolerance) {
  Eigen::Matrix3Xd points(3, 4);
  points.col(0) << 499999.9999999984, 5e6, 100.00000000241451;
  points.col(1) << 500000.00000000285, 5000000.000000002, 99.99999999996304;
  points.col(2) << 500000.0000009951, 5000000.000001993, 100.00000299236248;
  points.col(3) << 500000.00000099954, 5000000.000001995, 100.00000298991101;
  const SplineBasis line(1, {0, 0, 1, 1});
  const SurfaceOffset offset = OffsetSurface(NurbsSurface(line, line, points), 0.1);
  EXPECT_LT(offset.surface.size_u(), 50);
  EXPECT_FALSE(offset.tolerance_reached);
}

TEST(OffsetSurfaceTest, AnEllipsoidKeepsItsPoles) {
  const NurbsSurface sphere = MakeSphere({}, 1);
  const NurbsSurface ellipsoid =
      WithPoints(sphere, Eigen::Vector3d(1, 1.3, 0.8).asDiagonal() * sphere.control_points());
  constexpr double kTolerance = 1e-4;
  const SurfaceOffset offset = OffsetSurface(ellipsoid, 0.2, {.tolerance = kTolerance});
  EXPECT_TRUE(offset.tolerance_reached);
  EXPECT_LE(FarthestFromExact(ellipsoid, offset.surface, 0.2, 157), kTolerance);
}

TEST(OffsetSurfaceTest, ADistanceBeyondTheRadiusNamesRadiusAndPlace) {
  try {
    OffsetSurface(MakeTorus({}, 2, 0.5), -0.7);
    FAIL();
  } catch (const std::invalid_argument& refusal) {
    EXPECT_NE(std::string(refusal.what()).find("smallest radius of curvature 0.5 "),
              std::string::npos)
        << refusal.what();
  }
  EXPECT_THROW(OffsetSurface(MakeSphere({}, 1), 0), std::invalid_argument);
}

TEST(OffsetSurfaceTest, ACreaseIsRefusedByItsKnot) {
  Eigen::Matrix3Xd points(3, 6);
  points << 0, 0, 1, 1, 2, 2, 0, 1, 0, 1, 0, 1, 0, 0, 1, 1, 0, 0;
  const NurbsSurface roof(SplineBasis(1, {0, 0, 1, 2, 2}), SplineBasis(1, {0, 0, 1, 1}), points);
  try {
    OffsetSurface(roof, 0.1);
    FAIL();
  } catch (const std::invalid_argument& refusal) {
    EXPECT_NE(std::string(refusal.what()).find("u = 1"), std::string::npos) << refusal.what();
  }
}

// A sheet bent like a U whose legs come to lie in one another.
TEST(OffsetSurfaceTest, LegsThatRunThroughEachOtherAreReported) {
  const SplineBasis u = SplineBasis::Uniform(3, 7, 0, 1), v = SplineBasis::Uniform(3, 4, 0, 1);
  const double x[] = {0, 1.3, -1.5, 1, 3.5, 0.7, 2}, z[] = {5, 3, -1, -3, -1, 3, 5};
  Eigen::Matrix3Xd points(3, 28);
  for (int i = 0; i < 7; ++i) {
    for (int j = 0; j < 4; ++j) points.col(4 * i + j) << x[i], j, z[i];
  }
  const NurbsSurface bottle(u, v, points);
  const SurfaceOffset in = OffsetSurface(bottle, -0.55, {.tolerance = 1e-4});
  const SurfaceOffset out = OffsetSurface(bottle, 0.55, {.tolerance = 1e-4});
  EXPECT_NE(in.self_meetings.empty(), out.self_meetings.empty());
}

}  // namespace batten::internal::offset_surface_test
