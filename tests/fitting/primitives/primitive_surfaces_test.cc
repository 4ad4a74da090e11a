// SPDX-License-Identifier: MIT
// Planes, spheres, cylinders, cones and tori: exact where the points are, with patches that hold
// the points, and the same shape in every place, attitude and unit.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <variant>

#include "batten/fitting/distances.h"
#include "batten/fitting/fit_primitive.h"
#include "batten/geometry/exact_shape.h"
#include "geometry/numeric/constants.h"
#include "measured_shapes.h"
#include "primitive_clouds.h"
#include "tolerances.h"

namespace batten::internal::primitive_surfaces_test {

using ::testing::HasSubstr;

PrimitiveKind KindOf(SurfaceKind kind) {
  return static_cast<PrimitiveKind>(static_cast<int>(PrimitiveKind::kPlane) +
                                    static_cast<int>(kind));
}

double DistanceOffShape(const PrimitiveShape& shape, const Eigen::Vector3d& p) {
  return std::visit([&](const auto& s) { return DistanceTo(s, p); }, shape);
}

// Every point's foot is on the patch, at its parameters, along the normal there.
void ExpectFeet(const PrimitiveFit& fit, const Eigen::Matrix3Xd& points, double rounding) {
  const NurbsSurface& surface = std::get<NurbsSurface>(fit.geometry);
  ASSERT_EQ(fit.parameters.cols(), points.cols());
  for (Eigen::Index k = 0; k < points.cols(); ++k) {
    if (fit.outliers[k]) continue;
    const double u = fit.parameters(0, k), v = fit.parameters(1, k);
    const Eigen::Vector3d from = points.col(k) - surface.At(u, v);
    ASSERT_NEAR(from.norm(), std::abs(fit.residuals[k]), rounding) << k;
    const std::optional<Eigen::Vector3d> normal = surface.NormalAt(u, v);
    if (normal && from.norm() > 100 * rounding) {
      ASSERT_NEAR(from.dot(*normal), fit.residuals[k], rounding) << k;
    }
  }
}

TEST(PrimitiveSurfacesTest, ExactPointsGiveExactShapes) {
  RandomSplines random(1);
  for (int trial = 0; trial < 100; ++trial) {
    SCOPED_TRACE("seed 1, trial " + std::to_string(trial));
    const SurfaceKind kind = kSurfaceKinds[trial % 5];
    SCOPED_TRACE(Name(kind));
    const bool far = trial % 3 == 0;
    MeasuredShape truth = RandomShape(kind, random, far ? 1e6 : 1);
    const ShapePiece piece = RandomPiece(truth, random);
    const Eigen::Matrix3Xd points = RandomPoints(truth, piece, 400, random);
    const double rounding = far ? 1e-8 : 1e-11;  // short pieces have levers
    const PrimitiveFit fit = FitPrimitive(Cloud(points, false), Options(KindOf(kind)));
    ASSERT_EQ(fit.shape.index(), static_cast<size_t>(KindOf(kind)) - 1);
    EXPECT_LT(fit.residuals.cwiseAbs().maxCoeff(), rounding);
    EXPECT_LT(OffShape(fit), rounding);
    EXPECT_EQ(fit.outliers.count(), 0);
    for (int k = 0; k < 20; ++k) {
      const Eigen::Vector3d p = truth.At(piece.u_start + random.Real(0, 1) * piece.u_length,
                                         piece.v_start + random.Real(0, 1) * piece.v_length);
      EXPECT_LT(DistanceOffShape(fit.shape, p), rounding);
    }
    ExpectFeet(fit, points, rounding);
    const GeometrySummary& report = fit.report.geometry;
    EXPECT_EQ(report.kind, "surface");
    EXPECT_EQ(report.base, Name(kind));
    if (kind != SurfaceKind::kPlane && kind != SurfaceKind::kSphere) {
      EXPECT_EQ(report.closed[0], piece.u_length > 0.9 * kTurn);
    }
    // The patch is what the exact shapes of geometry are, so that STEP gets it as such.
    EXPECT_TRUE(far || ExactShapeOf(std::get<NurbsSurface>(fit.geometry)));
  }
}

TEST(PrimitiveSurfacesTest, NoiseIsAlongTheNormals) {
  RandomSplines random(2);
  for (int trial = 0; trial < 40; ++trial) {
    SCOPED_TRACE("seed 2, trial " + std::to_string(trial));
    const SurfaceKind kind = kSurfaceKinds[trial % 5];
    SCOPED_TRACE(Name(kind));
    const MeasuredShape truth = RandomShape(kind, random);
    const ShapePiece piece = RandomPiece(truth, random);
    const Eigen::Matrix3Xd points = RandomPoints(truth, piece, 500, random, 1e-3);
    const PrimitiveFit fit = FitPrimitive(Cloud(points, false), Options(KindOf(kind)));
    ExpectFeet(fit, points, 1e-11);
    EXPECT_NEAR(fit.report.geometry.primitive->scale, 1e-3, 2e-4);
    EXPECT_NEAR(fit.report.error.rms, 1e-3, 2e-4);
  }
}

// Whole or a part of it, and noise twice as large changes nothing.
void ExpectKindsFound(int trials, int points, unsigned seed) {
  RandomSplines random(seed);
  for (int trial = 0; trial < trials; ++trial) {
    const SurfaceKind kind = kSurfaceKinds[trial % 5];
    SCOPED_TRACE("seed " + std::to_string(seed) + ", trial " + std::to_string(trial) + ", " +
                 Name(kind));
    const MeasuredShape truth = RandomShape(kind, random);
    const ShapePiece piece = PieceOf(truth, random.Coin() ? 1 : 0.3, random);
    const Eigen::Matrix3Xd clean = RandomPoints(truth, piece, points, random);
    Noise noise(static_cast<unsigned>(trial));
    Eigen::Matrix3Xd errors = Eigen::Matrix3Xd::Zero(3, clean.cols());
    noise.AddTo(errors, 5e-4, false);
    for (const double factor : {0.0, 1.0, 2.0}) {
      const PrimitiveFit fit = FitPrimitive(Cloud(clean + factor * errors, false));
      EXPECT_EQ(fit.report.geometry.base, Name(kind))
          << factor << " " << fit.report.geometry.primitive->why;
      EXPECT_TRUE(fit.report.warnings.empty());
    }
  }
}

TEST(PrimitiveSurfacesTest, TheKindIsFound) { ExpectKindsFound(10, 500, 3); }

TEST(LongPrimitiveSurfacesTest, TheKindIsFound) { ExpectKindsFound(200, 1500, 4); }

TEST(PrimitiveSurfacesTest, ANoisyDiscIsAPlane) {
  RandomSplines random(4);
  for (int trial = 0; trial < 12; ++trial) {
    SCOPED_TRACE("seed 4, trial " + std::to_string(trial));
    Eigen::Matrix3Xd points(3, random.Integer(100, 500));
    for (auto p : points.colwise()) {
      const double r = std::sqrt(random.Real(0, 1)), a = random.Real(0, kTurn);
      p << r * std::cos(a), r * std::sin(a), 0;
    }
    Noise noise(static_cast<unsigned>(trial));
    noise.AddTo(points, random.Logarithmic(1e-4, 0.03), false);
    const PrimitiveFit fit = FitPrimitive(Cloud(RandomPlace(random, false)(points), false));
    EXPECT_EQ(fit.report.geometry.base, "plane") << fit.report.geometry.primitive->why;
  }
}

TEST(PrimitiveSurfacesTest, SaysSoWhereNothingExplainsThePoints) {
  RandomSplines random(5);
  Eigen::Matrix3Xd blob(3, 3000);
  for (auto p : blob.colwise()) p = random.Vector(1);
  const PrimitiveFit fit = FitPrimitive(Cloud(blob, false));
  ASSERT_FALSE(fit.report.warnings.empty());
  EXPECT_THAT(fit.report.warnings.front(), HasSubstr("explains the points"));
}

TEST(PrimitiveSurfacesTest, PlaceAttitudeAndUnitChangeNothing) {
  RandomSplines random(6);
  for (int trial = 0; trial < 20; ++trial) {
    SCOPED_TRACE("seed 6, trial " + std::to_string(trial));
    const SurfaceKind kind = kSurfaceKinds[trial % 5];
    const MeasuredShape truth = RandomShape(kind, random);
    const Eigen::Matrix3Xd points =
        RandomPoints(truth, PieceOf(truth, 0.5, random), 300, random, 2e-3);
    Place place = RandomPlace(random, false);
    place.scale = random.Coin() ? 1e6 : 1e-6;
    place.shift *= place.scale;
    const PrimitiveFit here = FitPrimitive(Cloud(points, false), Options(KindOf(kind)));
    const PrimitiveFit there = FitPrimitive(Cloud(place(points), false), Options(KindOf(kind)));
    EXPECT_NEAR(there.report.error.rms / place.scale, here.report.error.rms, 1e-9);
    for (int k = 0; k < 10; ++k) {
      const Eigen::Vector3d p = random.Vector(1);
      EXPECT_NEAR(DistanceOffShape(there.shape, place(p)) / place.scale,
                  DistanceOffShape(here.shape, p),
                  1e-6);
    }
    const PrimitiveAccuracy& a = *here.report.geometry.primitive->accuracy;
    const PrimitiveAccuracy& b = *there.report.geometry.primitive->accuracy;
    if (here.report.geometry.primitive->radius) {
      EXPECT_NEAR(b.Deviation("radius") / place.scale / a.Deviation("radius"), 1, 1e-3);
    }
  }
}

TEST(PrimitiveSurfacesTest, OutliersCountInNothing) {
  RandomSplines random(7);
  for (int trial = 0; trial < 20; ++trial) {
    SCOPED_TRACE("seed 7, trial " + std::to_string(trial));
    const SurfaceKind kind = kSurfaceKinds[trial % 5];
    SCOPED_TRACE(Name(kind));
    const MeasuredShape truth = RandomShape(kind, random);
    const ShapePiece piece = PieceOf(truth, 0.5, random);
    Eigen::Matrix3Xd points = RandomPoints(truth, piece, 1500, random, 1e-3);
    const Eigen::Vector3d low = points.rowwise().minCoeff(), high = points.rowwise().maxCoeff();
    for (int k = 0; k < 300; ++k) {
      for (int d = 0; d < 3; ++d) {
        points(d, 5 * k) = random.Real(low[d] - 0.2, high[d] + 0.2);
      }
    }
    const std::optional<Loss> loss = random.Coin() ? std::optional(Loss::kTukey) : std::nullopt;
    const PrimitiveFit fit = FitPrimitive(Cloud(points, false), Options(KindOf(kind), loss));
    EXPECT_GT(fit.report.input.outliers, 200);
    double squares = 0;
    for (int k = 0; k < 200; ++k) {
      const Eigen::Vector3d p = truth.At(piece.u_start + random.Real(0, 1) * piece.u_length,
                                         piece.v_start + random.Real(0, 1) * piece.v_length);
      squares += std::pow(DistanceOffShape(fit.shape, p), 2) / 200;
    }
    EXPECT_LT(std::sqrt(squares), 4e-4);
    // Distances of points beyond the edges are those from the patch.
    const NurbsSurface& surface = std::get<NurbsSurface>(fit.geometry);
    for (int k = 0; k < 1500; k += 5) {
      const Eigen::Vector3d foot = surface.At(fit.parameters(0, k), fit.parameters(1, k));
      EXPECT_NEAR((points.col(k) - foot).norm(), std::abs(fit.residuals[k]), 1e-9);
    }
  }
}

TEST(PrimitiveSurfacesTest, IsTheSameForEveryNumberOfThreads) {
  RandomSplines random(8);
  for (const SurfaceKind kind : kSurfaceKinds) {
    const MeasuredShape truth = RandomShape(kind, random);
    const PointCloud cloud =
        Cloud(RandomPoints(truth, PieceOf(truth, 0.5, random), 15000, random, 1e-3), false);
    PrimitiveFitOptions options = Options(PrimitiveKind::kAuto);
    options.threads = 1;
    const PrimitiveFit one = FitPrimitive(cloud, options);
    options.threads = 3;
    const PrimitiveFit three = FitPrimitive(cloud, options);
    EXPECT_EQ(std::get<NurbsSurface>(one.geometry), std::get<NurbsSurface>(three.geometry));
    EXPECT_EQ(one.residuals, three.residuals);
    EXPECT_EQ(one.report.geometry.primitive->accuracy->standard_deviations,
              three.report.geometry.primitive->accuracy->standard_deviations);
  }
}

TEST(PrimitiveSurfacesTest, WarnsOfAnApexInsideTheData) {
  RandomSplines random(9);
  MeasuredShape cone;
  cone.kind = SurfaceKind::kCone;
  cone.Place();
  Eigen::Matrix3Xd points(3, 2000);
  points << RandomPoints(cone, {0, kTurn, 0, 1}, 1000, random, 1e-3),
      RandomPoints(cone, {0, kTurn, -1, 1}, 1000, random, 1e-3);
  const PrimitiveFit fit = FitPrimitive(Cloud(points, false), Options(PrimitiveKind::kCone));
  ASSERT_FALSE(fit.report.warnings.empty());
  EXPECT_THAT(fit.report.warnings.front(), HasSubstr("apex is inside the data"));
  EXPECT_NEAR(std::get<ConeShape>(fit.shape).half_angle, cone.half_angle, 1e-3);
}

TEST(PrimitiveSurfacesTest, RefusesWhatDeterminesNothing) {
  RandomSplines random(10);
  const auto refused = [](const Eigen::Matrix3Xd& points, SurfaceKind kind, bool plane = false) {
    try {
      FitPrimitive(Cloud(points, plane), Options(KindOf(kind)));
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  for (const SurfaceKind kind : kSurfaceKinds) {
    SCOPED_TRACE(Name(kind));
    const Place place = RandomPlace(random, false);
    EXPECT_THAT(refused(place(LinePoints(50, 1)), kind), HasSubstr("collinear"));
    Eigen::Matrix3Xd flat(3, 200);
    for (auto p : flat.colwise()) p << random.Real(0, 1), random.Real(0, 2), 0;
    EXPECT_THAT(refused(flat, kind, true), HasSubstr("three coordinates"));
    const Eigen::Matrix3Xd few = Eigen::Matrix3Xd::Random(3, FreedomsOf(kind) - 1);
    EXPECT_THAT(refused(few, kind), HasSubstr("needs at least"));
    if (kind == SurfaceKind::kPlane) continue;
    EXPECT_THAT(refused(place(flat), kind), HasSubstr("coplanar"));
  }
}

// A figure of eight is no circle, and no noise made it of one.
TEST(PrimitiveSurfacesTest, SaysWhereNoKindExplainsThePoints) {
  Eigen::Matrix3Xd points(3, 400);
  for (int k = 0; k < 400; ++k) {
    const double t = 2 * std::numbers::pi * k / 400;
    points.col(k) << std::sin(t), std::sin(2 * t), 0;
  }
  const PrimitiveFit fit = FitPrimitive(PointCloud::FromWorld(points, 2));
  ASSERT_EQ(fit.report.warnings.size(), 1);
  EXPECT_THAT(fit.report.warnings.front(), HasSubstr("explains the points"));
  EXPECT_EQ(fit.report.termination, Termination::kStalled);
}

// No scale of noise makes a lattice in a cube any of these.
TEST(PrimitiveSurfacesTest, RefusesALossThatLeavesTooFewPoints) {
  Eigen::Matrix3Xd points(3, 343);
  for (int k = 0; k < 343; ++k) {
    points.col(k) << k % 7 + 0.1 * std::sin(k), k / 7 % 7 + 0.1 * std::sin(2 * k),
        k / 49 + 0.1 * std::sin(3 * k);
  }
  const PointCloud cloud = PointCloud::FromWorld(points);
  for (const PrimitiveKind kind : {PrimitiveKind::kPlane,
                                   PrimitiveKind::kSphere,
                                   PrimitiveKind::kCylinder,
                                   PrimitiveKind::kCone,
                                   PrimitiveKind::kTorus}) {
    SCOPED_TRACE(Name(kind));
    try {
      FitPrimitive(cloud, {.kind = kind, .loss_scale = 1e-13});
      ADD_FAILURE() << "not refused";
    } catch (const std::invalid_argument& error) {
      EXPECT_THAT(error.what(), HasSubstr("scale is too small"));
    }
  }
}

// Nearly flat clouds leave radii open up to infinity; of control points so far away few digits are
// left for the piece through the points, and what is reported is what is written.
TEST(PrimitiveSurfacesTest, DistancesOfUndeterminedShapesAreThoseOfThePatch) {
  int fitted = 0;
  for (unsigned seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const double flat = std::pow(10.0, -random.Integer(2, 12));
    Eigen::Matrix3Xd points(3, 40);
    for (Eigen::Index k = 0; k < points.cols(); ++k)
      points.col(k) = random.Vector(1).cwiseProduct(Eigen::Vector3d(1, 0.6, flat));
    try {
      const PrimitiveFit fit =
          FitPrimitive(PointCloud::FromWorld(points), Options(KindOf(kSurfaceKinds[seed % 5])));
      ++fitted;
      ThreadPool pool(1);
      const NurbsSurface& surface = std::get<NurbsSurface>(fit.geometry);
      const Eigen::VectorXd written = DistancesTo(surface, points, pool).distances;
      for (Eigen::Index k = 0; k < points.cols(); ++k) {
        ASSERT_NEAR(std::abs(fit.residuals[k]), std::abs(written[k]), 1e-11) << k;
      }
    } catch (const std::invalid_argument&) {  // refused
    }
  }
  EXPECT_GT(fitted, 30);
}

}  // namespace batten::internal::primitive_surfaces_test
