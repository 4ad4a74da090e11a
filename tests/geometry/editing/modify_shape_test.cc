// SPDX-License-Identifier: MIT
#include "batten/geometry/modify_shape.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vector>

#include "law_cases.h"
#include "shape_edits.h"
#include "tolerances.h"

namespace batten::internal::modify_shape_test {

template <int Dim>
void CheckMovedCurves() {
  ForRandomCurves<Dim>([](const NurbsCurve<Dim>& unit, RandomSplines& random) {
    for (const double scale : kCoordinateScales) {
      const NurbsCurve<Dim> curve = Enlarged(unit, scale);
      const double u = random.Parameter(curve.basis());
      const typename NurbsCurve<Dim>::Point to = random.Vector(3 * scale).template head<Dim>();
      const NurbsCurve<Dim> moved = MovedPoint(curve, u, to);
      const double bound = 8 * (curve.basis().degree() + 1) * kUnitRoundoff * ExtentOf(moved);
      EXPECT_LE((moved.At(u) - to).norm(), bound) << "u = " << u;
      EXPECT_EQ(moved.basis(), curve.basis());
      EXPECT_EQ(moved.weights(), curve.weights());
    }
  });
}

TEST(ModifyShapeTest, CurvesPassThroughThePointTheyAreMovedTo) {
  CheckMovedCurves<2>();
  CheckMovedCurves<3>();
}

TEST(ModifyShapeTest, SurfacesPassThroughThePointTheyAreMovedTo) {
  ForRandomSurfaces([](const NurbsSurface& unit, RandomSplines& random) {
    for (const double scale : kCoordinateScales) {
      const NurbsSurface surface = Enlarged(unit, scale);
      const SplineBasis &bu = surface.basis_u(), &bv = surface.basis_v();
      const double u = random.Parameter(bu), v = random.Parameter(bv);
      const Eigen::Vector3d to = random.Vector(3 * scale);
      const NurbsSurface moved = MovedPoint(surface, u, v, to);
      const double bound =
          8 * (bu.degree() + 1) * (bv.degree() + 1) * kUnitRoundoff * ExtentOf(moved);
      EXPECT_LE((moved.At(u, v) - to).norm(), bound) << "(u, v) = (" << u << ", " << v << ")";
      EXPECT_EQ(moved.weights(), surface.weights());
    }
  });
}

// What C(u) changes by when the free control point i moves by one: a difference, exact up to
// rounding because C is linear in its control points.
template <int Dim>
double Influence(const NurbsCurve<Dim>& curve, int i, double u) {
  const int round = curve.basis().periodic() ? curve.basis().size() - curve.basis().degree()
                                             : curve.basis().size();
  typename NurbsCurve<Dim>::Points points = curve.control_points();
  for (int k = i; k < curve.basis().size(); k += round) points(0, k) += 1;
  return NurbsCurve<Dim>(curve.basis(), points, curve.weights()).At(u)[0] - curve.At(u)[0];
}

// The least change is the one that no change that keeps C(u) is part of: it is orthogonal to all of
// them. Changes that keep C(u) are spanned by the pairs (R_j at i, −R_i at j).
TEST(ModifyShapeTest, TheChangeOfACurveIsTheLeastOfAll) {
  ForRandomCurves<3>([](const NurbsCurve<3>& curve, RandomSplines& random) {
    const double u = random.Parameter(curve.basis());
    const NurbsCurve<3> moved = MovedPoint(curve, u, random.Vector(2));
    const NurbsCurve<3>::Points change = moved.control_points() - curve.control_points();
    const int free = curve.basis().periodic() ? curve.basis().size() - curve.basis().degree()
                                              : curve.basis().size();
    for (int i = 0; i < free; ++i) {
      for (int j = 0; j < i; ++j) {
        const double ri = Influence(curve, i, u), rj = Influence(curve, j, u);
        EXPECT_LE((rj * change.col(i) - ri * change.col(j)).norm(), kRounding * 10);
      }
    }
  });
}

TEST(ModifyShapeTest, OnlyThePiecesNearTheParameterChange) {
  ForRandomSurfaces([](const NurbsSurface& surface, RandomSplines& random) {
    if (surface.basis_u().periodic() || surface.basis_v().periodic()) return;
    const SplineBasis &bu = surface.basis_u(), &bv = surface.basis_v();
    const double u = random.Parameter(bu), v = random.Parameter(bv);
    const NurbsSurface moved = MovedPoint(surface, u, v, random.Vector(2));
    const int su = bu.Span(u), sv = bv.Span(v);
    for (int i = 0; i < surface.size_u(); ++i) {
      for (int j = 0; j < surface.size_v(); ++j) {
        const bool acts = i >= su - bu.degree() && i <= su && j >= sv - bv.degree() && j <= sv;
        if (!acts) {
          EXPECT_EQ(moved.control_point(i, j), surface.control_point(i, j));
        }
      }
    }
  });
}

TEST(ModifyShapeTest, ANewWeightDrawsPointsStraightToItsControlPoint) {
  ForRandomCurves<3>([](const NurbsCurve<3>& curve, RandomSplines& random) {
    const int i = random.Integer(0, curve.basis().size() - 1);
    const Eigen::Vector3d target = curve.control_points().col(i);
    const double w = random.Logarithmic(1e-2, 1e2);
    const NurbsCurve<3> lighter = WithWeight(curve, i, w);
    const NurbsCurve<3> heavier = WithWeight(curve, i, 10 * w);
    EXPECT_EQ(lighter.weights()[i], w);
    EXPECT_EQ(lighter.control_points(), curve.control_points());
    EXPECT_EQ(lighter.basis(), curve.basis());
    const double u = random.Parameter(curve.basis());
    const Eigen::Vector3d from = lighter.At(u) - target, to = heavier.At(u) - target;
    EXPECT_LE(to.norm(), from.norm() + kRounding);
    EXPECT_LE(from.cross(to).norm(), kRounding);  // on one line, on the same side
    EXPECT_GE(from.dot(to), -kRounding);
  });
}

TEST(ModifyShapeTest, AWeightOfAPeriodicShapeIsThatOfAllItsCopies) {
  RandomSplines random(1);
  for (int trial = 0; trial < 40; ++trial) {
    SCOPED_TRACE(trial);
    const int p = random.Integer(1, 6), q = random.Integer(1, 6);
    const NurbsSurface surface = random.Surface(p, q, true, KindOfBasis(2), KindOfBasis(trial % 3));
    const int i = random.Integer(0, surface.size_u() - 1);
    const int j = random.Integer(0, surface.size_v() - 1);
    const NurbsSurface changed = WithWeight(surface, i, j, 123);  // the constructor checks copies
    EXPECT_EQ(changed.weights()[i * surface.size_v() + j], 123);
    const NurbsCurve<2> curve = random.Curve<2>(p, false, KindOfBasis(2));
    const int k = random.Integer(0, curve.basis().size() - 1);
    EXPECT_EQ(WithWeight(curve, k, 5).weights()[k], 5);
  }
}

TEST(ModifyShapeTest, PutsTheOldWeightBackBitByBit) {
  ForRandomSurfaces([](const NurbsSurface& surface, RandomSplines& random) {
    const int i = random.Integer(0, surface.size_u() - 1);
    const int j = random.Integer(0, surface.size_v() - 1);
    const double old = surface.weights()[i * surface.size_v() + j];
    EXPECT_EQ(WithWeight(WithWeight(surface, i, j, 7 * old), i, j, old), surface);
  });
}

TEST(ModifyShapeTest, WrapsParametersOfPeriodicShapes) {
  RandomSplines random(3);
  const NurbsCurve<3> curve = random.Curve<3>(3, true, KindOfBasis(2));
  const SplineBasis& basis = curve.basis();
  const double period = basis.upper() - basis.lower(), u = basis.lower() + 0.4 * period;
  const NurbsCurve<3> moved = MovedPoint(curve, u + 3 * period, {4, 5, 6});
  EXPECT_LE((moved.At(u) - Eigen::Vector3d(4, 5, 6)).norm(), kRounding * ExtentOf(moved));
}

TEST(ModifyShapeTest, RefusesWhatItCannotDo) {
  RandomSplines random(4);
  const NurbsCurve<3> curve(SplineBasis::Uniform(2, 4, 0, 1), Eigen::Matrix3Xd::Random(3, 4));
  const NurbsSurface surface(SplineBasis::Uniform(1, 2, 0, 1),
                             SplineBasis::Uniform(2, 4, 0, 1),
                             Eigen::Matrix3Xd::Random(3, 8));
  EXPECT_EQ(RefusalOf([&] { WithWeight(curve, 4, 1); }),
            "WithWeight: index i = 4 is not in [0, 3]");
  EXPECT_EQ(RefusalOf([&] { WithWeight(curve, -1, 1); }),
            "WithWeight: index i = -1 is not in [0, 3]");
  EXPECT_EQ(RefusalOf([&] { WithWeight(surface, 1, 4, 1); }),
            "WithWeight: index j = 4 is not in [0, 3]");
  EXPECT_EQ(RefusalOf([&] { WithWeight(surface, 2, 0, 1); }),
            "WithWeight: index i = 2 is not in [0, 1]");
  for (const double weight : {0.0, -1.0, std::nan(""), HUGE_VAL}) {
    EXPECT_THAT(RefusalOf([&] { WithWeight(curve, 0, weight); }),
                testing::HasSubstr("is not positive and finite"));
  }
  EXPECT_EQ(RefusalOf([&] { MovedPoint(curve, 1.5, Eigen::Vector3d::Zero()); }),
            "MovedPoint: u = 1.5 is outside the domain [0, 1]");
  EXPECT_EQ(RefusalOf([&] { MovedPoint(surface, 0.5, -0.25, Eigen::Vector3d::Zero()); }),
            "MovedPoint: v = -0.25 is outside the domain [0, 1]");
  EXPECT_EQ(RefusalOf([&] { MovedPoint(curve, 0.5, Eigen::Vector3d(0, NAN, 0)); }),
            "MovedPoint: the point is not finite");
}

}  // namespace batten::internal::modify_shape_test
