// SPDX-License-Identifier: MIT
#include "batten/geometry/transform.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <numbers>

#include "exact_shapes.h"
#include "law_cases.h"
#include "shape_edits.h"
#include "tolerances.h"

namespace batten::internal::transform_test {

// Any affine map; one time in three a projection to a plane, which is singular. Shifts are as large
// as the shape.
Eigen::Matrix4d RandomAffine(RandomSplines& random, double extent, bool in_plane) {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  for (double& x : matrix.topLeftCorner<3, 3>().reshaped()) x = random.Real(-2, 2);
  if (random.Integer(0, 2) == 0) matrix.row(0) = 0.5 * matrix.row(1);
  matrix.topRightCorner<3, 1>() = random.Vector(3 * extent);
  if (in_plane) {
    matrix.block<1, 2>(2, 0).setZero();
    matrix(2, 3) = 0;
  }
  return matrix;
}

// The last coordinate is in [0.1, 1.9] on the cube of half side `extent`.
Eigen::Matrix4d RandomPerspective(RandomSplines& random, double extent, bool in_plane) {
  Eigen::Matrix4d matrix = RandomAffine(random, extent, in_plane);
  matrix.bottomLeftCorner<1, 3>() = random.Vector(0.3 / extent).transpose();
  return matrix;
}

Eigen::Vector3d Lifted(const Eigen::VectorXd& point) {
  Eigen::Vector3d result = Eigen::Vector3d::Zero();
  result.head(point.size()) = point;
  return result;
}

Eigen::Vector3d Image(const Eigen::Matrix4d& matrix, const Eigen::VectorXd& point) {
  return (matrix * Lifted(point).homogeneous()).hnormalized();
}

// The size of the sums that make a coordinate of the image, and that make the last coordinate.
double SumSize(const Eigen::Matrix4d& matrix, double extent) {
  const Eigen::Vector4d most(extent, extent, extent, 1);
  return (matrix.topRows<3>().cwiseAbs() * most).maxCoeff();
}

// A bound for the distance of an image from the map of its original, in units of roundings: 4ε of
// the sums for the image points, the same relative to f for f, which is divided by, and 4(p + 1)ε
// for the evaluations before and after.
double Bound(const Eigen::Matrix4d& matrix, const Eigen::Matrix3Xd& points, int degrees) {
  const double extent = points.cwiseAbs().maxCoeff();
  const Eigen::RowVectorXd f = matrix.row(3) * points.colwise().homogeneous();
  const double f_sum = matrix.row(3).head<3>().cwiseAbs().sum() * extent + std::abs(matrix(3, 3));
  const double smallest = f.minCoeff();
  return 4 * (degrees + 2) * kUnitRoundoff * SumSize(matrix, extent) / smallest *
         (1 + f_sum / smallest);
}

Eigen::Matrix3Xd Lifted(const NurbsCurve<2>& curve) {
  Eigen::Matrix3Xd points = Eigen::Matrix3Xd::Zero(3, curve.basis().size());
  points.topRows<2>() = curve.control_points();
  return points;
}
Eigen::Matrix3Xd Lifted(const NurbsCurve<3>& curve) { return curve.control_points(); }

template <int Dim>
void CheckCurves(bool perspective) {
  ForRandomCurves<Dim>([&](const NurbsCurve<Dim>& unit, RandomSplines& random) {
    for (const double scale : kCoordinateScales) {
      const NurbsCurve<Dim> curve = Enlarged(unit, scale);
      const Eigen::Matrix4d matrix = perspective ? RandomPerspective(random, scale, Dim == 2)
                                                 : RandomAffine(random, scale, Dim == 2);
      const NurbsCurve<Dim> image = Transformed(curve, matrix);
      EXPECT_EQ(image.basis(), curve.basis());
      if (!perspective) {
        EXPECT_EQ(image.weights(), curve.weights());
      }
      const double bound = Bound(matrix, Lifted(curve), curve.basis().degree());
      for (int trial = 0; trial < 5; ++trial) {
        const double u = random.Parameter(curve.basis());
        EXPECT_LE((Lifted(image.At(u)) - Image(matrix, curve.At(u))).norm(), bound) << "u = " << u;
      }
    }
  });
}

TEST(TransformTest, AffineMapsOfCurvesMapEveryPoint) {
  CheckCurves<2>(false);
  CheckCurves<3>(false);
}

TEST(TransformTest, PerspectiveMapsOfCurvesMapEveryPoint) {
  CheckCurves<2>(true);
  CheckCurves<3>(true);
}

TEST(TransformTest, MapsEveryPointOfSurfaces) {
  ForRandomSurfaces([](const NurbsSurface& unit, RandomSplines& random) {
    for (const double scale : kCoordinateScales) {
      const NurbsSurface surface = Enlarged(unit, scale);
      const int degrees = surface.basis_u().degree() + surface.basis_v().degree() + 1;
      const Eigen::Matrix4d affine = RandomAffine(random, scale, false);
      const Eigen::Matrix4d perspective = RandomPerspective(random, scale, false);
      const NurbsSurface moved = Transformed(surface, affine);
      const NurbsSurface seen = Transformed(surface, perspective);
      EXPECT_EQ(moved.weights(), surface.weights());
      for (int trial = 0; trial < 5; ++trial) {
        const double u = random.Parameter(surface.basis_u());
        const double v = random.Parameter(surface.basis_v());
        const Eigen::Vector3d point = surface.At(u, v);
        EXPECT_LE((moved.At(u, v) - Image(affine, point)).norm(),
                  Bound(affine, surface.control_points(), degrees));
        EXPECT_LE((seen.At(u, v) - Image(perspective, point)).norm(),
                  Bound(perspective, surface.control_points(), degrees));
      }
    }
  });
}

TEST(TransformTest, MatricesThatDifferByAFactorAreTheSameMap) {
  RandomSplines random(1);
  const NurbsCurve<3> curve = random.Curve<3>(3, true);
  const Eigen::Matrix4d matrix = RandomAffine(random, 1, false);
  EXPECT_EQ(Transformed(curve, 4 * matrix), Transformed(curve, matrix));
}

TEST(TransformTest, InverseMapsUndo) {
  RandomSplines random(2);
  for (int trial = 0; trial < 50; ++trial) {
    const NurbsSurface surface = random.Surface(3, 2, true, KindOfBasis(trial % 3));
    Eigen::Matrix4d matrix = RandomPerspective(random, 1, false);
    matrix.topLeftCorner<3, 3>() += 4 * Eigen::Matrix3d::Identity();
    const NurbsSurface back = Transformed(Transformed(surface, matrix), matrix.inverse());
    const double condition = matrix.norm() * matrix.inverse().norm();
    EXPECT_LE((back.control_points() - surface.control_points()).cwiseAbs().maxCoeff(),
              100 * condition * condition * kUnitRoundoff);
    // Weights come back up to the scale that the matrix and its inverse share.
    EXPECT_LE((back.weights().cwiseQuotient(surface.weights()).array() - 1).abs().maxCoeff(),
              100 * condition * condition * kUnitRoundoff);
  }
}

TEST(TransformTest, TranslationAndScalingAreWhatTheirNamesSay) {
  RandomSplines random(3);
  const NurbsSurface surface = random.Surface(2, 3, true);
  EXPECT_EQ(Transformed(surface, Translation({1, -2, 3})), surface.Translated({1, -2, 3}));
  EXPECT_EQ(Transformed(surface, Scaling(-2)), Enlarged(surface, -2));
  const NurbsCurve<2> curve = random.Curve<2>(3, false);
  const NurbsCurve<2> line = Transformed(curve, Scaling(Eigen::Vector3d(1, 0, 5)));
  EXPECT_TRUE(line.control_points().row(1).isZero(0));
  EXPECT_EQ(line.control_points().row(0), curve.control_points().row(0));
}

TEST(TransformTest, RotationsAreThoseOfTheirAxisAndAngle) {
  RandomSplines random(4);
  for (int trial = 0; trial < 100; ++trial) {
    const Eigen::Vector3d axis = random.Logarithmic(1e-9, 1e9) * random.Vector(1);
    const double angle = random.Real(-10, 10);
    const Eigen::Matrix3d got = Rotation(axis, angle).topLeftCorner<3, 3>();
    const Eigen::Matrix3d expected = Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
    EXPECT_LE((got - expected).cwiseAbs().maxCoeff(), 16 * kUnitRoundoff);
    EXPECT_LE((got * got.transpose() - Eigen::Matrix3d::Identity()).norm(), 32 * kUnitRoundoff);
  }
}

TEST(TransformTest, RotationsAboutZLeaveHeightsBitByBitAndKeepThePlane) {
  RandomSplines random(5);
  const NurbsCurve<3> curve = random.Curve<3>(3, true);
  const NurbsCurve<3> turned = Transformed(curve, Rotation({0, 0, 7}, 1.234));
  EXPECT_EQ(turned.control_points().row(2), curve.control_points().row(2));
  // A half turn about an axis in the plane keeps it too, though sin π is not zero in doubles.
  const NurbsCurve<2> flat = random.Curve<2>(3, true);
  const NurbsCurve<2> flipped = Transformed(flat, Rotation({1, 1, 0}, std::numbers::pi));
  EXPECT_LE((flipped.control_points().row(0) - flat.control_points().row(1)).norm(), kRounding);
}

TEST(TransformTest, ACircleSeenInPerspectiveIsStillAConicWithItsFiveExactPoints) {
  const NurbsCurve<2> circle = Circle(1);
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  matrix(3, 0) = 0.5;  // the plane x = −2 goes to infinity: an ellipse
  const NurbsCurve<2> ellipse = Transformed(circle, matrix);
  // x² + y² = 1 with x = X/(1 − X/2), y = Y/(1 − X/2): X² + Y² = (1 − X/2)².
  for (double u = 0; u <= 1; u += 1.0 / 64) {
    const Eigen::Vector2d p = ellipse.At(u);
    EXPECT_NEAR(p.squaredNorm(), (1 - p[0] / 2) * (1 - p[0] / 2), kRounding);
  }
}

TEST(TransformTest, RefusesWhatItCannotDo) {
  RandomSplines random(6);
  const NurbsCurve<3> curve = random.Curve<3>(3, false);
  const NurbsCurve<2> flat = random.Curve<2>(3, false);
  const NurbsSurface surface = random.Surface(2, 2, false);
  const auto refusal = [](const auto& shape, const Eigen::Matrix4d& matrix) {
    return RefusalOf([&] { Transformed(shape, matrix); });
  };
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  matrix(1, 2) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(refusal(curve, matrix), "Transformed: the matrix is not finite");
  EXPECT_EQ(refusal(flat, matrix), "Transformed: the matrix is not finite");
  EXPECT_EQ(refusal(surface, Eigen::Matrix4d::Constant(INFINITY)),
            "Transformed: the matrix is not finite");
  matrix.setIdentity();
  matrix(3, 0) = 100;
  EXPECT_THAT(refusal(curve, matrix),
              testing::HasSubstr("plane that the matrix sends to infinity"));
  EXPECT_THAT(refusal(surface, matrix), testing::HasSubstr("on or behind"));
  EXPECT_THAT(refusal(curve, Eigen::Matrix4d::Zero()), testing::HasSubstr("on or behind"));
  EXPECT_THAT(refusal(flat, Rotation({1, 0, 0}, 0.1)),
              testing::HasSubstr("moves a plane curve out of its plane z = 0"));
  EXPECT_THAT(refusal(flat, Translation({1, 1, 1e-9})), testing::HasSubstr("out of its plane"));
  EXPECT_THAT(refusal(curve, Scaling(1e308) * Scaling(1e10)), testing::HasSubstr("not finite"));
  EXPECT_THAT(refusal(Enlarged(curve, 1e200), Scaling(1e200)), testing::HasSubstr("not finite"));
  EXPECT_THAT(RefusalOf([] { Rotation(Eigen::Vector3d::Zero(), 1); }),
              testing::HasSubstr("the axis is zero"));
  EXPECT_THAT(RefusalOf([] { Rotation({1, 0, 0}, INFINITY); }), testing::HasSubstr("angle"));
}

}  // namespace batten::internal::transform_test
