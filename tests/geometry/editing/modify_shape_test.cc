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

// |RP'|/|P'Q| over |RP|/|PQ| with R at a weight of nearly zero: what the weight is multiplied by.
void ExpectCrossRatio(const Eigen::Vector3d& rest,
                      const Eigen::Vector3d& from,
                      const Eigen::Vector3d& to,
                      const Eigen::Vector3d& towards,
                      double factor) {
  const double before = (from - rest).norm() / (towards - from).norm();
  const double after = (to - rest).norm() / (towards - to).norm();
  EXPECT_NEAR(after / before / factor, 1, kHalfDigits);
}

TEST(ModifyShapeTest, APullMovesThePointOfACurveByItsLengthAndTheWeightByTheCrossRatio) {
  ForRandomCurves<3>([](const NurbsCurve<3>& curve, RandomSplines& random) {
    const SplineBasis& basis = curve.basis();
    const double u = random.Real(basis.lower(), basis.upper());
    const int span = basis.Span(u), i = span - random.Integer(0, basis.degree());
    const Eigen::Vector3d from = curve.At(u), towards = curve.control_points().col(i);
    const double reach = (towards - from).norm(), by = random.Real(0.05, 0.9) * reach;
    if (basis.Function(i, u) < 1e-3 || reach < 1e-3) return;
    const NurbsCurve<3> pulled = Pulled(curve, u, std::vector{i}, by);
    const Eigen::Vector3d to = pulled.At(u);
    EXPECT_LE((to - (from + by / reach * (towards - from))).norm(), 1e2 * kRounding);
    EXPECT_EQ(pulled.control_points(), curve.control_points());
    const double factor = pulled.weights()[i] / curve.weights()[i];
    ExpectCrossRatio(
        WithWeight(curve, i, 1e-12 * curve.weights()[i]).At(u), from, to, towards, factor);
    // Back again.
    const NurbsCurve<3> back = Pulled(pulled, u, std::vector{i}, -by);
    EXPECT_NEAR(back.weights()[i] / curve.weights()[i], 1, kIterated);
  });
}

TEST(ModifyShapeTest, TwoNeighbouringWeightsPullTowardsTheirLegAndKeepTheirRatio) {
  ForRandomCurves<2>([](const NurbsCurve<2>& curve, RandomSplines& random) {
    const SplineBasis& basis = curve.basis();
    if (basis.degree() < 2) return;  // on a polygon the leg is all there is
    const double u = random.Real(basis.lower(), basis.upper());
    const int i = basis.Span(u) - random.Integer(1, basis.degree());
    const double a = basis.Function(i, u) * curve.weights()[i],
                 b = basis.Function(i + 1, u) * curve.weights()[i + 1];
    if (basis.Function(i, u) < 1e-3 || basis.Function(i + 1, u) < 1e-3) return;
    if (basis.periodic() && basis.size() - basis.degree() < basis.degree() + 1) return;
    const Eigen::Vector2d foot =
        (a * curve.control_points().col(i) + b * curve.control_points().col(i + 1)) / (a + b);
    const Eigen::Vector2d from = curve.At(u);
    const double reach = (foot - from).norm(), by = 0.5 * reach;
    if (reach < 1e-3) return;
    const NurbsCurve<2> pulled = Pulled(curve, u, std::vector{i, i + 1}, by);
    EXPECT_LE((pulled.At(u) - (from + 0.5 * (foot - from))).norm(), 1e2 * kRounding);
    EXPECT_NEAR(pulled.weights()[i] / pulled.weights()[i + 1],
                curve.weights()[i] / curve.weights()[i + 1],
                kRounding * curve.weights()[i] / curve.weights()[i + 1]);
  });
}

TEST(ModifyShapeTest, APullMovesThePointOfASurfaceByItsLengthAndTheWeightByTheCrossRatio) {
  ForRandomSurfaces([](const NurbsSurface& surface, RandomSplines& random) {
    const SplineBasis &bu = surface.basis_u(), &bv = surface.basis_v();
    const double u = random.Real(bu.lower(), bu.upper()), v = random.Real(bv.lower(), bv.upper());
    const int i = bu.Span(u) - random.Integer(0, bu.degree());
    const int j = bv.Span(v) - random.Integer(0, bv.degree());
    const Eigen::Vector3d from = surface.At(u, v), towards = surface.control_point(i, j);
    const double reach = (towards - from).norm(), by = random.Real(0.05, 0.5) * reach;
    if (bu.Function(i, u) * bv.Function(j, v) < 1e-3 || reach < 1e-3) return;
    const NurbsSurface pulled = Pulled(surface, u, v, i, j, by);
    const Eigen::Vector3d to = pulled.At(u, v);
    EXPECT_LE((to - (from + by / reach * (towards - from))).norm(), 1e2 * kRounding);
    const double old = surface.weights()[i * surface.size_v() + j];
    const double factor = pulled.weights()[i * surface.size_v() + j] / old;
    ExpectCrossRatio(WithWeight(surface, i, j, 1e-12 * old).At(u, v), from, to, towards, factor);
  });
}

TEST(ModifyShapeTest, RefusesPullsWhoseWeightsWouldNotBePositive) {
  // (1 − u)² (0, 0) + 2u(1 − u) (1, 1) + u² (2, 0): (1, 1/2) in the middle, (1, 0) without
  // weight 1.
  const NurbsCurve<2> parabola(SplineBasis::Uniform(2, 3, 0, 1),
                               Eigen::Matrix2Xd{{0, 1, 2}, {0, 1, 0}});
  const auto refusal = [&](int i, double u, double by) {
    return RefusalOf([&] { Pulled(parabola, u, std::vector{i}, by); });
  };
  EXPECT_THAT(refusal(1, 0.5, 0.5), testing::HasSubstr("by = 0.5 is not less than 0.5"));
  EXPECT_THAT(refusal(1, 0.5, 7), testing::HasSubstr("the weight would be infinite"));
  EXPECT_THAT(refusal(1, 0.5, -0.5), testing::HasSubstr("by = -0.5 is not above -0.5"));
  EXPECT_THAT(refusal(1, 0, 0.1), testing::HasSubstr("does not act at the parameter"));
  EXPECT_THAT(refusal(0, 0, 0.1), testing::HasSubstr("nothing else acts"));
  EXPECT_THAT(refusal(3, 0.5, 0.1), testing::HasSubstr("index i = 3 is not in [0, 2]"));
  EXPECT_THAT(refusal(1, 1.5, 0.1), testing::HasSubstr("u = 1.5 is outside the domain [0, 1]"));
  EXPECT_THAT(RefusalOf([&] {
                Pulled(parabola, 0.5, std::vector{0, 2}, 0.1);
              }),
              testing::HasSubstr("two neighbours i and i + 1"));
  EXPECT_NEAR(Pulled(parabola, 0.5, std::vector{1}, 0.25).weights()[1], 3, kRounding);
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
